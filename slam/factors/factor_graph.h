#pragma once

#include <ceres/cost_function.h>
#include <ceres/evaluation_callback.h>
#include <ceres/loss_function.h>
#include <ceres/problem.h>

#include <memory>
#include <unordered_set>
#include <vector>

#include "slam/factors/bearing_cost.h"
#include "slam/factors/gnss_cost.h"
#include "slam/factors/imu_preintegration.h"
#include "slam/factors/linear_prior.h"
#include "slam/factors/parameter_arena.h"
#include "slam/factors/wheel_preintegration.h"

namespace parkade {

/// The parameter blocks of a state node.
struct NodeBlocks {
  double* pose = nullptr;
  double* motion = nullptr;
};

/// The parameter blocks of a camera's calibration.
struct CameraBlocks {
  double* extrinsics = nullptr;
  double* timing = nullptr;
};

/// How a graph is solved.
struct GraphSolverOptions {
  /// Landmarks are eliminated first. SchurSolver takes Ceres' steps, which it is compared with, in
  /// less time and in all threads.
  enum class Solver { kSchurSolver, kCeresDense, kCeresSparse };
  Solver solver = Solver::kSchurSolver;
  int max_iterations = 10;
  double function_tolerance = 1e-5;
  double trust_region = 1e6;  ///< 1 / this share of the diagonal is added at the start
};

/// What one solve was like, for reports and tests.
struct SolveSummary {
  int iterations = 0;
  double seconds = 0;
  double final_cost = 0;
  int landmarks = 0;
  int bearings = 0;
  bool is_usable = false;
};

/// The measurements of a drive, or of a part of it, as one least-squares problem over blocks of
/// parameters: states of nodes, wheel scale, calibration of the cameras, landmarks, and where odom
/// lies in the site. The one place where costs, losses and manifolds meet; what is in a graph is
/// its caller's policy. Blocks and factors keep the order in which they are added, on which the
/// last bit of a result depends. Deterministic.
///
/// Blocks lie in `arena`; it, and the measurements given by reference, must outlive the graph.
class FactorGraph {
 public:
  /// \param bearing_weight  of the loss of bearings beside the other factors'
  FactorGraph(ParameterArena& arena, double bearing_weight);
  FactorGraph(const FactorGraph&) = delete;
  FactorGraph& operator=(const FactorGraph&) = delete;

  // States. Adding one again changes nothing.
  void AddPose(double* pose, bool is_free) { AddBlock(pose, kPoseSize, &manifold_, is_free); }
  void AddMotion(double* motion, bool is_free) { AddBlock(motion, kMotionSize, nullptr, is_free); }
  void AddWheelScale(double* scale, bool is_free) { AddBlock(scale, 1, nullptr, is_free); }
  void AddCamera(const CameraBlocks& camera, bool frees_extrinsics, bool frees_timing);
  void AddSiteFromOdom(double* site, bool is_free) { AddBlock(site, kSiteSize, nullptr, is_free); }
  void AddLandmark(double* landmark);

  // Factors, of states that were added.
  void AddPrior(const LinearPrior& prior, const std::vector<double*>& blocks);
  void AddImu(const ImuPreintegration& imu, const NodeBlocks& i, const NodeBlocks& j);
  void AddWheels(const WheelPreintegration& wheels, const NodeBlocks& i, const NodeBlocks& j,
                 double* wheel_scale);
  void AddStandstill(const NodeBlocks& i, const NodeBlocks& j);
  /// A measured relative pose; see RelativePoseCost.
  void AddLoop(const Rigid3& from_from_to, const Matrix6d& square_root_weight, double* from_pose,
               double* to_pose);
  /// A position of the antenna between two nodes.
  void AddFix(const AntennaFix& fix, double* pose_i, double* pose_j, double* site_from_odom);
  /// A bearing of a landmark, in `view`, whose pose is kept up to date during a solve.
  void AddBearing(BearingCost& bearing, ImageView& view, double* landmark);

  bool Contains(const double* block) const { return problem_.HasParameterBlock(block); }

  /// Half the sum of all losses at the blocks' values.
  double Cost();
  /// Moves the free blocks to the optimum; where none is found, all stay as they were.
  SolveSummary Solve(const GraphSolverOptions& options);

  const ceres::Problem& problem() const { return problem_; }
  const std::vector<double*>& landmarks() const { return landmarks_; }

 private:
  /// Recomputes the pose of each image once per evaluation instead of once per bearing.
  class ViewUpdater final : public ceres::EvaluationCallback {
   public:
    void Add(ImageView& view) {
      if (known_.insert(&view).second) views_.push_back(&view);
    }
    void PrepareForEvaluation(bool, bool new_evaluation_point) override {
      if (new_evaluation_point) Update();
    }
    void Update();

   private:
    std::vector<ImageView*> views_;
    std::unordered_set<const ImageView*> known_;
  };

  static ceres::Problem::Options ProblemOptions(ceres::EvaluationCallback* callback);
  SolveSummary SolveBySchur(const GraphSolverOptions& options);
  SolveSummary SolveByCeres(const GraphSolverOptions& options);
  void AddBlock(double* block, int size, ceres::Manifold* manifold, bool is_free);
  void AddFactor(std::unique_ptr<ceres::CostFunction> cost, ceres::LossFunction* loss,
                 const std::vector<double*>& blocks);

  ParameterArena& arena_;
  ViewUpdater views_;
  PoseManifold manifold_;
  ceres::CauchyLoss loss_;
  ceres::ScaledLoss bearing_loss_;
  std::vector<std::unique_ptr<ceres::CostFunction>> costs_;
  std::vector<double*> free_states_;
  std::vector<double*> landmarks_;
  int num_bearings_ = 0;
  ceres::Problem problem_;  // last: it goes before what it points to
};

}  // namespace parkade
