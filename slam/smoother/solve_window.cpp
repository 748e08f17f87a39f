// The non-linear solve of FixedLagSmoother: one Ceres problem per node.
#include <ceres/ceres.h>

#include <algorithm>

#include "slam/factors/imu_cost.h"
#include "slam/factors/track_errors.h"
#include "slam/factors/wheel_cost.h"
#include "slam/smoother/fixed_lag_smoother.h"

namespace parkade {
namespace {

/// 1 / this is added to the diagonal: enough for landmarks at infinity, and little enough for four
/// iterations to move what only the sum of all measurements tells, as scale on a straight road.
constexpr double kTrustRegion = 1e7;

/// Recomputes the pose of each image once per evaluation instead of once per
/// bearing.
class WindowEvaluationCallback final : public ceres::EvaluationCallback {
 public:
  explicit WindowEvaluationCallback(std::deque<WindowView>& views) : views_(views) {}

  void PrepareForEvaluation(bool, bool new_evaluation_point) override {
    if (!new_evaluation_point) return;
    for (WindowView& view : views_) view.geometry.Update();
  }

 private:
  std::deque<WindowView>& views_;
};

/// All parameters in one array: Ceres orders blocks by address in places, and
/// the same log must give the same bytes on every run.
class ParameterArena {
 public:
  explicit ParameterArena(size_t capacity) { values_.reserve(capacity); }

  bool IsFinite() const {
    return std::all_of(values_.begin(), values_.end(),
                       [](double value) { return std::isfinite(value); });
  }

  template <size_t N>
  double* Add(const std::array<double, N>& block) {
    values_.insert(values_.end(), block.begin(), block.end());
    return values_.data() + values_.size() - N;
  }

 private:
  std::vector<double> values_;
};

ceres::Problem::Options ProblemOptions(ceres::EvaluationCallback* callback) {
  ceres::Problem::Options options;
  options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.disable_all_safety_checks = true;
  options.evaluation_callback = callback;
  return options;
}

ceres::Solver::Options SolverOptions(int max_iterations) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_SCHUR;
  options.max_num_iterations = max_iterations;
  options.num_threads = 1;  // cameras are tracked beside this; and sums keep their order
  options.function_tolerance = 1e-4;
  options.initial_trust_region_radius = kTrustRegion;
  options.logging_type = ceres::SILENT;
  options.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  return options;
}

using Kind = StateName::Kind;

struct NodeBlocks {
  double* pose;
  double* motion;
};

struct CameraBlocks {
  double* extrinsics;
  double* timing;
};

}  // namespace

SolveSummary FixedLagSmoother::SolveWindow(int max_iterations) {
  WindowEvaluationCallback callback(views_);
  PoseManifold manifold;
  ceres::ScaledLoss bearing_loss = BearingLoss(options_.robust_width);
  ceres::CauchyLoss wheel_loss(options_.wheel_robust_width);
  std::vector<std::unique_ptr<ceres::CostFunction>> costs;
  ceres::Solver::Options solver = SolverOptions(max_iterations);
  ceres::Problem problem(ProblemOptions(&callback));

  ParameterArena arena(nodes_.size() * (kPoseSize + kMotionSize) + 1 +
                       cameras_.size() * (kPoseSize + kTimingSize) +
                       tracks_.size() * kLandmarkSize);
  std::vector<NodeBlocks> blocks;
  for (const StateNode& node : nodes_) {
    blocks.push_back({arena.Add(node.pose), arena.Add(node.motion)});
    problem.AddParameterBlock(blocks.back().pose, kPoseSize, &manifold);
    problem.AddParameterBlock(blocks.back().motion, kMotionSize);
    solver.linear_solver_ordering->AddElementToGroup(blocks.back().pose, 1);
    solver.linear_solver_ordering->AddElementToGroup(blocks.back().motion, 1);
  }
  double* wheel_scale = arena.Add(std::array<double, 1>{wheel_scale_});
  problem.AddParameterBlock(wheel_scale, 1);
  solver.linear_solver_ordering->AddElementToGroup(wheel_scale, 1);
  const auto blocks_of = [&](std::int64_t number) {
    return blocks[static_cast<size_t>(number - nodes_.front().number)];
  };

  std::vector<CameraBlocks> cameras;
  for (size_t i = 0; i < cameras_.size(); ++i) {
    const auto add = [&](auto& values, Kind kind, ceres::Manifold* on) {
      double* block = arena.Add(values);
      problem.AddParameterBlock(block, static_cast<int>(values.size()), on);
      solver.linear_solver_ordering->AddElementToGroup(block, 1);
      if (!IsEstimated({kind, static_cast<std::int64_t>(i)}))
        problem.SetParameterBlockConstant(block);
      return block;
    };
    double* extrinsics = add(cameras_[i].extrinsics, Kind::kExtrinsics, &manifold);
    cameras.push_back({extrinsics, add(cameras_[i].timing, Kind::kTiming, nullptr)});
  }
  const auto block_of = [&](const StateName& name) {
    const auto camera = static_cast<size_t>(name.number);
    switch (name.kind) {
      case Kind::kPose: return blocks_of(name.number).pose;
      case Kind::kMotion: return blocks_of(name.number).motion;
      case Kind::kExtrinsics: return cameras[camera].extrinsics;
      case Kind::kTiming: return cameras[camera].timing;
      case Kind::kWheelScale: break;
    }
    return wheel_scale;
  };

  for (WindowView& view : views_) {
    view.geometry.first_pose = blocks_of(view.first_node).pose;
    if (view.second_node) view.geometry.second_pose = blocks_of(*view.second_node).pose;
    view.geometry.extrinsics = cameras[static_cast<size_t>(view.camera)].extrinsics;
    view.geometry.timing = cameras[static_cast<size_t>(view.camera)].timing;
  }

  costs.push_back(std::make_unique<LinearPriorCost>(&prior_));
  std::vector<double*> prior_blocks;
  for (const PriorBlock& block : prior_.blocks) prior_blocks.push_back(block_of(block.name));
  problem.AddResidualBlock(costs.back().get(), nullptr, prior_blocks);

  for (size_t j = 1; j < nodes_.size(); ++j) {
    const NodeInterval& interval = *nodes_[j].interval;
    costs.push_back(std::make_unique<ImuCost>(&interval.imu));
    problem.AddResidualBlock(costs.back().get(), nullptr, blocks[j - 1].pose, blocks[j - 1].motion,
                             blocks[j].pose, blocks[j].motion);
    if (interval.wheels) {
      costs.push_back(std::make_unique<WheelCost>(*interval.wheels));
      problem.AddResidualBlock(costs.back().get(), &wheel_loss, blocks[j - 1].pose,
                               blocks[j - 1].motion, blocks[j].pose, wheel_scale);
    }
    if (interval.is_still) {
      costs.push_back(std::make_unique<StandstillCost>(options_.standstill));
      problem.AddResidualBlock(costs.back().get(), nullptr, blocks[j - 1].pose, blocks[j].pose,
                               blocks[j].motion);
    }
  }

  SolveSummary summary;
  std::vector<std::pair<Track*, double*>> landmarks;
  std::vector<double*> bearing_blocks;
  for (auto& [number, track] : tracks_) {
    if (!track.has_landmark) continue;
    double* landmark = arena.Add(track.landmark);
    landmarks.emplace_back(&track, landmark);
    problem.AddParameterBlock(landmark, kLandmarkSize);
    solver.linear_solver_ordering->AddElementToGroup(landmark, 0);
    for (const TrackObservation& seen : track.observations) {
      bearing_blocks.clear();
      for (const StateName& name : StatesOf(*seen.view)) bearing_blocks.push_back(block_of(name));
      bearing_blocks.push_back(landmark);
      problem.AddResidualBlock(seen.cost.get(), &bearing_loss, bearing_blocks);
      ++summary.bearings;
    }
  }
  summary.landmarks = static_cast<int>(landmarks.size());

  ceres::Solver::Summary ceres_summary;
  ceres::Solve(solver, &problem, &ceres_summary);
  summary.iterations = static_cast<int>(ceres_summary.iterations.size()) - 1;
  summary.seconds = ceres_summary.total_time_in_seconds;
  summary.final_cost = ceres_summary.final_cost;

  if (ceres_summary.IsSolutionUsable() && arena.IsFinite()) {
    for (size_t i = 0; i < nodes_.size(); ++i) {
      std::copy_n(blocks[i].pose, kPoseSize, nodes_[i].pose.begin());
      std::copy_n(blocks[i].motion, kMotionSize, nodes_[i].motion.begin());
    }
    wheel_scale_ = *wheel_scale;
    for (size_t i = 0; i < cameras_.size(); ++i) {
      std::copy_n(cameras[i].extrinsics, kPoseSize, cameras_[i].extrinsics.begin());
      std::copy_n(cameras[i].timing, kTimingSize, cameras_[i].timing.begin());
    }
    for (const auto& [track, values] : landmarks)
      std::copy_n(values, kLandmarkSize, track->landmark.begin());
  }
  PointViewsAtNodes();
  return summary;
}

}  // namespace parkade
