// The non-linear problem of DriveAdjustment, its solution and how sure that is.
#include <ceres/ceres.h>

#include <algorithm>
#include <set>
#include <unordered_set>

#include "slam/factors/imu_cost.h"
#include "slam/factors/relative_pose_cost.h"
#include "slam/factors/wheel_cost.h"
#include "slam/refinement/drive_adjustment.h"
#include "slam/refinement/marginal_covariance.h"
#include "slam/smoother/standstill_cost.h"

namespace parkade {
namespace {

constexpr int kMinObservations = 2;  // of a landmark within a stretch

/// Recomputes the pose of each image once per evaluation instead of once per bearing.
class ImageCallback final : public ceres::EvaluationCallback {
 public:
  void Add(ImageView* view) { views_.push_back(view); }

  void PrepareForEvaluation(bool, bool new_evaluation_point) override {
    if (!new_evaluation_point) return;
    for (ImageView* view : views_) view->Update();
  }

 private:
  std::vector<ImageView*> views_;
};

ceres::Problem::Options ProblemOptions(ceres::EvaluationCallback* callback) {
  ceres::Problem::Options options;
  options.cost_function_ownership = options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.disable_all_safety_checks = true;
  options.evaluation_callback = callback;
  return options;
}

ceres::Solver::Options SolverOptions(int max_iterations) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_SCHUR;
  options.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
  options.max_num_iterations = max_iterations;
  options.num_threads = 1;  // sums keep their order
  options.function_tolerance = 1e-5;
  options.initial_trust_region_radius = 1e6;  // the pose graph has brought it near
  options.logging_type = ceres::SILENT;
  options.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  return options;
}

}  // namespace

/// A stretch of the drive as Ceres sees it.
struct DriveAdjustment::StretchProblem {
  explicit StretchProblem(const RefinementOptions& options)
      : loss(options.robust_width),
        // Residuals show the part of a track's errors that it does not share with its neighbors,
        // the smaller one.
        bearing_loss(&loss, 1 / (options.bearing_inflation * options.bearing_inflation),
                     ceres::DO_NOT_TAKE_OWNERSHIP),
        problem(ProblemOptions(&callback)) {}

  ImageCallback callback;
  PoseManifold manifold;
  ceres::CauchyLoss loss;
  ceres::ScaledLoss bearing_loss;
  std::vector<std::unique_ptr<ceres::CostFunction>> costs;
  std::vector<double*> states;  ///< free blocks but landmarks
  std::unordered_set<const double*> landmarks;
  ceres::Problem problem;  // before what it points to goes
};

std::unique_ptr<DriveAdjustment::StretchProblem> DriveAdjustment::BuildProblem(
    const AdjustedStretch& stretch) {
  const size_t begin = stretch.begin, end = stretch.end;
  PointImages();
  auto posed = std::make_unique<StretchProblem>(options_);
  ceres::Problem& problem = posed->problem;
  ceres::LossFunction* const loss = &posed->loss;
  std::set<const double*> known;
  const auto know = [&](double* block, int size, bool is_pose, bool is_free) {
    if (!known.insert(block).second) return;
    problem.AddParameterBlock(block, size, is_pose ? &posed->manifold : nullptr);
    if (is_free)
      posed->states.push_back(block);
    else
      problem.SetParameterBlockConstant(block);
  };
  const auto is_moved = [&](size_t node) { return node >= begin && node < end; };
  const auto pose_of = [&](size_t node) {
    know(nodes_[node].pose, kPoseSize, true, is_moved(node));
    return nodes_[node].pose;
  };
  const auto motion_of = [&](size_t node) {
    know(nodes_[node].motion, kMotionSize, false, is_moved(node));
    return nodes_[node].motion;
  };
  const auto add = [&](std::unique_ptr<ceres::CostFunction> cost, ceres::LossFunction* with,
                       const std::vector<double*>& blocks) {
    problem.AddResidualBlock(cost.get(), with, blocks);
    posed->costs.push_back(std::move(cost));
  };
  const bool frees_calibration = stretch.frees_calibration;
  const size_t last = stretch.has_open_end
                          ? end
                          : std::min(end + 1, nodes_.size());  // behind the nodes that matter

  // In the order of the drive, so that the factorization sees a band.
  for (size_t j = begin; j < last; ++j) {
    pose_of(j), motion_of(j);
    if (j == 0 || !nodes_[j].interval) continue;
    const NodeInterval& interval = *nodes_[j].interval;
    add(std::make_unique<ImuCost>(&interval.imu), nullptr,
        {pose_of(j - 1), motion_of(j - 1), pose_of(j), motion_of(j)});
    if (interval.is_still)
      add(std::make_unique<StandstillCost>(StandstillNoise()), nullptr,
          {pose_of(j - 1), pose_of(j), motion_of(j)});
    if (!interval.wheels) continue;
    know(wheel_scale_, 1, false, frees_calibration);
    add(std::make_unique<WheelCost>(*interval.wheels), loss,
        {pose_of(j - 1), motion_of(j - 1), pose_of(j), wheel_scale_});
  }
  for (size_t i = 0; i < cameras_.size(); ++i) {
    const CameraSigmas& prior = camera_priors_[i];
    know(cameras_[i].extrinsics, kPoseSize, true, frees_calibration && prior.rotation > 0);
    know(cameras_[i].timing, kTimingSize, false,
         frees_calibration && (prior.time_offset > 0 || prior.line_delay > 0));
  }
  for (const LinearPrior& prior : priors_) {
    const StateName& name = prior.blocks.front().name;
    const auto number = static_cast<size_t>(name.number);
    double* block = name.kind == StateName::Kind::kPose         ? nodes_[number].pose
                    : name.kind == StateName::Kind::kMotion     ? nodes_[number].motion
                    : name.kind == StateName::Kind::kExtrinsics ? cameras_[number].extrinsics
                    : name.kind == StateName::Kind::kTiming     ? cameras_[number].timing
                                                                : wheel_scale_;
    if (!known.contains(block)) continue;
    add(std::make_unique<LinearPriorCost>(&prior), nullptr, {block});
  }
  const auto is_left_out = [&](size_t node) { return stretch.has_open_end && node >= end; };
  for (const AdjustedLoop& loop : loops_)
    if (loop.is_used && (is_moved(loop.from) || is_moved(loop.to)) &&
        !is_left_out(std::max(loop.from, loop.to)))
      add(std::make_unique<RelativePoseCost>(loop.from_from_to, loop.square_root_weight), loss,
          {pose_of(loop.from), pose_of(loop.to)});

  for (const AdjustedFix& fix : fixes_) {
    if ((!is_moved(fix.first) && !is_moved(fix.first + 1)) || is_left_out(fix.first + 1)) continue;
    know(site_from_odom_, kSiteSize, false, frees_calibration);
    add(std::make_unique<GnssCost>(fix.antenna), loss,
        {pose_of(fix.first), pose_of(fix.first + 1), site_from_odom_});
  }

  std::vector<bool> is_seen(images_.size());
  for (AdjustedLandmark& landmark : landmarks_) {
    const bool concerns = std::any_of(landmark.observations.begin(), landmark.observations.end(),
                                      [&](const LandmarkObservation& seen) {
                                        return is_moved(images_[seen.image].first) ||
                                               is_moved(images_[seen.image].second);
                                      });
    const auto is_seen_here = [&](const LandmarkObservation& seen) {
      return !is_left_out(images_[seen.image].second);
    };
    if (!concerns || !landmark.is_used ||
        std::count_if(landmark.observations.begin(), landmark.observations.end(), is_seen_here) <
            kMinObservations)
      continue;
    problem.AddParameterBlock(landmark.values, kLandmarkSize);
    posed->landmarks.insert(landmark.values);
    for (const LandmarkObservation& observation : landmark.observations) {
      if (!is_seen_here(observation)) continue;
      Image& image = images_[observation.image];
      pose_of(image.first), pose_of(image.second);
      if (!is_seen[observation.image]) posed->callback.Add(&image.geometry);
      is_seen[observation.image] = true;
      std::vector<double*> blocks = BlocksOf(image);
      blocks.push_back(landmark.values);
      problem.AddResidualBlock(observation.cost.get(), &posed->bearing_loss, blocks);
    }
  }
  return posed;
}

int DriveAdjustment::Solve(const AdjustedStretch& stretch, int max_iterations) {
  const std::unique_ptr<StretchProblem> posed = BuildProblem(stretch);
  ceres::Solver::Options solver = SolverOptions(max_iterations);
  for (double* block : posed->states) solver.linear_solver_ordering->AddElementToGroup(block, 1);
  for (AdjustedLandmark& landmark : landmarks_)
    if (posed->landmarks.contains(landmark.values))
      solver.linear_solver_ordering->AddElementToGroup(landmark.values, 0);
  const std::vector<double> before = values_;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &posed->problem, &summary);
  const bool is_finite = std::all_of(values_.begin(), values_.end(),
                                     [](double value) { return std::isfinite(value); });
  if (!summary.IsSolutionUsable() || !is_finite)
    std::copy(before.begin(), before.end(), values_.begin());
  PointImages();
  return static_cast<int>(summary.iterations.size()) - 1;
}

std::optional<Eigen::MatrixXd> DriveAdjustment::PoseCovariance(const std::vector<size_t>& nodes) {
  const std::unique_ptr<StretchProblem> posed = BuildProblem({0, nodes_.size(), false, true});
  std::vector<const double*> poses;
  for (const size_t node : nodes) poses.push_back(nodes_[node].pose);
  return MarginalCovariance(posed->problem, posed->landmarks, poses);
}

}  // namespace parkade
