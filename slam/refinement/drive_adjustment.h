#pragma once

#include <array>
#include <memory>
#include <vector>

#include "core/rig.h"
#include "slam/factors/gnss_cost.h"
#include "slam/factors/linear_prior.h"
#include "slam/pose_graph/pose_graph.h"
#include "slam/refinement/adjusted_landmark.h"
#include "slam/refinement/adjustment_statistics.h"
#include "slam/refinement/refinement_options.h"
#include "slam/smoother/drive_measurements.h"

namespace parkade {

/// A loop as a measured relative pose of the IMU at two nodes.
struct AdjustedLoop {
  size_t from = 0, to = 0;  ///< indices of nodes
  Rigid3 from_from_to;
  Matrix6d square_root_weight = Matrix6d::Identity();  ///< of RelativePoseError
  bool is_used = true;                                 ///< false: looked at, but pulls nothing
};

/// A GNSS fix between node `first` and the next.
struct AdjustedFix {
  size_t first = 0;
  AntennaFix antenna;
};

/// Nodes [begin, end) that move in a solve.
struct AdjustedStretch {
  size_t begin = 0, end = 0;
  bool has_open_end =
      false;  ///< what hangs on nodes from `end` on is left out; else they hold their keyframes
  bool frees_calibration = false;
};

/// All states of a drive, its landmarks, the wheel scale and the calibration of its cameras as one
/// least-squares problem: the costs of FixedLagSmoother without window and marginalization, plus
/// loops and GNSS. Landmarks are eliminated first (Schur), the rest is a band with an arrow.
/// Results do not depend on the number of threads.
class DriveAdjustment {
 public:
  /// \param rig    what the drive's log says: calibration has its prior there
  /// \param start  states of all nodes, from which landmarks are triangulated
  DriveAdjustment(const DriveMeasurements& measurements, const Rig& rig,
                  const std::vector<MotionState>& start, const RefinementOptions& options);
  ~DriveAdjustment();
  DriveAdjustment(const DriveAdjustment&) = delete;
  DriveAdjustment& operator=(const DriveAdjustment&) = delete;

  void SetLoops(std::vector<AdjustedLoop> loops) { loops_ = std::move(loops); }

  /// Fixes, and about where odom lies among them.
  void SetGnss(std::vector<AdjustedFix> fixes, const Rigid3& site_from_odom);

  /// Moves the nodes of `stretch`; those outside stay. The first node of the drive keeps position
  /// and yaw. Returns the number of steps.
  int Solve(const AdjustedStretch& stretch, int max_iterations);

  /// The covariance of the poses of `nodes` around the solution, [rotation in imu, position in
  /// odom] each; position and yaw of the first node of the drive are certain. See
  /// MarginalCovariance.
  std::optional<Eigen::MatrixXd> PoseCovariance(const std::vector<size_t>& nodes);

  /// Moves nodes by one motion of odom each, at their keyframes in time, and triangulates all
  /// landmarks anew.
  void MoveNodes(const std::vector<Rigid3>& odom_from_odom);
  void SetCalibration(const std::vector<CameraParameters>& cameras, double wheel_scale);

  /// Every so many-th landmark pulls nothing and judges the others; 0: all pull.
  void HoldOutLandmarks(size_t every);

  /// Moves each landmark to where its bearings meet best from the nodes' current poses.
  void FitLandmarks();

  /// Leaves out bearings that are too far off, and landmarks that too few are left of.
  void RejectOutliers();

  AdjustmentStatistics Statistics() const;
  std::vector<MotionState> States() const;
  std::vector<CameraParameters> Cameras() const;
  double WheelScale() const { return *wheel_scale_; }
  const std::vector<AdjustedLoop>& loops() const { return loops_; }
  size_t num_nodes() const { return nodes_.size(); }

 private:
  struct StretchProblem;
  using ChosenTrack = std::vector<SeenTrack>;
  static std::vector<ChosenTrack> ChooseTracks(const DriveMeasurements& measurements,
                                               const RefinementOptions& options);
  struct Image {
    int camera = 0;
    size_t first = 0, second = 0;  ///< indices of nodes; the same where the image is at a node
    Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  ///< bias included
    ImageView geometry;
  };
  struct AdjustedNode {
    Timestamp time;
    double* pose = nullptr;
    double* motion = nullptr;
    std::optional<NodeInterval> interval;
  };
  struct CameraBlocks {
    double* extrinsics = nullptr;
    double* timing = nullptr;
  };
  std::unique_ptr<StretchProblem> BuildProblem(const AdjustedStretch& stretch);
  void AddNodes(const DriveMeasurements& measurements, const std::vector<MotionState>& start);
  void AddImages(const DriveMeasurements& measurements);
  void AddLandmarks(const DriveMeasurements& measurements, const std::vector<ChosenTrack>& tracks);
  void HoldHeads(const Rig& rig);
  void AddPriors(const Rig& rig);
  void PointImages();
  bool Triangulate(AdjustedLandmark& landmark) const;
  void FitLandmark(AdjustedLandmark& landmark) const;
  double RobustErrorOf(const AdjustedLandmark& landmark) const;
  std::vector<double*> BlocksOf(const Image& image) const;

  RefinementOptions options_;
  std::vector<double> values_;  ///< all parameter blocks: Ceres orders by address
  std::vector<AdjustedNode> nodes_;
  std::vector<CameraBlocks> cameras_;
  std::vector<CameraSigmas> camera_priors_;
  double* wheel_scale_ = nullptr;
  double* site_from_odom_ = nullptr;  ///< yaw and translation; unused without fixes
  std::vector<Image> images_;
  std::vector<AdjustedLandmark> landmarks_;
  std::vector<AdjustedLoop> loops_;
  std::vector<AdjustedFix> fixes_;
  std::vector<LinearPrior> priors_;
};

}  // namespace parkade
