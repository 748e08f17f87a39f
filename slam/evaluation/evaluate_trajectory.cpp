#include "slam/evaluation/evaluate_trajectory.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>

#include "core/error.h"
#include "slam/georeference/align_points.h"

namespace parkade {
namespace {

/// Poses of the same instants in the two worlds, and how far the car had come.
struct Matches {
  std::vector<Timestamp> times;
  std::vector<Rigid3> truth, estimate;
  std::vector<double> traveled;  ///< [m] along the truth since the first match

  size_t size() const { return times.size(); }
};

void RequireIncreasingTimes(const std::vector<TimedPose>& poses, const std::string& name) {
  const auto bad =
      std::adjacent_find(poses.begin(), poses.end(),
                         [](const TimedPose& a, const TimedPose& b) { return a.time >= b.time; });
  if (bad == poses.end()) return;
  throw Error(ErrorCode::kInvalidInput, "the times of the " + name + " do not increase after " +
                                            ToDecimalSeconds(bad->time) + " s");
}

std::optional<Rigid3> TruthAt(const std::vector<TimedPose>& truth, Timestamp time, double max_gap) {
  const auto after =
      std::lower_bound(truth.begin(), truth.end(), time,
                       [](const TimedPose& pose, Timestamp t) { return pose.time < t; });
  if (after == truth.end()) return std::nullopt;
  if (after->time == time) return after->world_from_frame;
  if (after == truth.begin()) return std::nullopt;
  const auto before = std::prev(after);
  const double gap = after->time - before->time;
  if (gap > max_gap) return std::nullopt;
  return Interpolate(before->world_from_frame, after->world_from_frame,
                     (time - before->time) / gap);
}

Matches Associate(const std::vector<TimedPose>& truth, const std::vector<TimedPose>& estimate,
                  double max_gap) {
  Matches matches;
  for (const TimedPose& pose : estimate) {
    const std::optional<Rigid3> true_pose = TruthAt(truth, pose.time, max_gap);
    if (!true_pose) continue;
    matches.times.push_back(pose.time);
    matches.truth.push_back(*true_pose);
    matches.estimate.push_back(pose.world_from_frame);
  }
  if (matches.size() == 0) return matches;

  // Along every pose of the truth, so that a sparse estimate does not shorten the path.
  auto next = std::upper_bound(truth.begin(), truth.end(), matches.times.front(),
                               [](Timestamp t, const TimedPose& pose) { return t < pose.time; });
  Eigen::Vector3d last = matches.truth.front().translation;
  double traveled = 0;
  for (size_t i = 0; i < matches.size(); ++i) {
    for (; next != truth.end() && next->time < matches.times[i]; ++next) {
      traveled += (next->world_from_frame.translation - last).norm();
      last = next->world_from_frame.translation;
    }
    traveled += (matches.truth[i].translation - last).norm();
    last = matches.truth[i].translation;
    matches.traveled.push_back(traveled);
  }
  return matches;
}

ErrorSummary Summarize(std::vector<double> errors) {
  ErrorSummary summary;
  if (errors.empty()) return summary;
  const double count = static_cast<double>(errors.size());
  std::sort(errors.begin(), errors.end());
  summary.mean = std::accumulate(errors.begin(), errors.end(), 0.0) / count;
  summary.rmse =
      std::sqrt(std::inner_product(errors.begin(), errors.end(), errors.begin(), 0.0) / count);
  summary.median = 0.5 * (errors[(errors.size() - 1) / 2] + errors[errors.size() / 2]);
  summary.max = errors.back();
  return summary;
}

AbsoluteError AbsoluteAfter(const Rigid3& truth_from_estimate, const Matches& matches) {
  std::vector<double> translations, rotations;
  for (size_t i = 0; i < matches.size(); ++i) {
    const Rigid3 moved = truth_from_estimate * matches.estimate[i];
    translations.push_back((moved.translation - matches.truth[i].translation).norm());
    rotations.push_back(moved.rotation.angularDistance(matches.truth[i].rotation));
  }
  return {truth_from_estimate, Summarize(std::move(translations)), Summarize(std::move(rotations))};
}

/// Stretches from every match to the first one that is `length` further along
/// `position` (which never decreases).
RelativeError RelativeOver(double length, const std::vector<double>& position,
                           const Matches& matches) {
  RelativeError error;
  error.length = length;
  std::vector<double> translations, rotations;
  size_t end = 0;
  for (size_t begin = 0; begin < matches.size(); ++begin) {
    while (end < matches.size() && position[end] - position[begin] < length * (1 - 1e-9)) ++end;
    if (end == matches.size()) break;
    const Rigid3 true_motion = matches.truth[begin].Inverse() * matches.truth[end];
    const Rigid3 motion = matches.estimate[begin].Inverse() * matches.estimate[end];
    const Rigid3 difference = true_motion.Inverse() * motion;
    translations.push_back(difference.translation.norm());
    rotations.push_back(LogSo3(difference.rotation).norm());
  }
  error.count = translations.size();
  error.translation = Summarize(std::move(translations));
  error.rotation = Summarize(std::move(rotations));
  return error;
}

Eigen::Matrix3Xd PositionsOf(const std::vector<Rigid3>& poses) {
  Eigen::Matrix3Xd positions(3, static_cast<Eigen::Index>(poses.size()));
  for (size_t i = 0; i < poses.size(); ++i)
    positions.col(static_cast<Eigen::Index>(i)) = poses[i].translation;
  return positions;
}

/// Each pose as a rigid body: its position and the ends of three arms along its axes.
Eigen::Matrix3Xd BodiesOf(const std::vector<Rigid3>& poses) {
  constexpr double kArm = 5;  // [m] as far as most of the ground that is mapped lies beside the car
  Eigen::Matrix3Xd points(3, static_cast<Eigen::Index>(4 * poses.size()));
  for (size_t i = 0; i < poses.size(); ++i) {
    auto body = points.middleCols<4>(static_cast<Eigen::Index>(4 * i));
    body.col(0) = poses[i].translation;
    body.rightCols<3>() =
        (kArm * poses[i].rotation.toRotationMatrix()).colwise() + poses[i].translation;
  }
  return points;
}

nlohmann::json JsonOf(const ErrorSummary& summary) {
  return {{"rmse", summary.rmse},
          {"mean", summary.mean},
          {"median", summary.median},
          {"max", summary.max}};
}

nlohmann::json JsonOf(const AbsoluteError& error) {
  const Eigen::Vector3d& p = error.truth_from_estimate.translation;
  const Eigen::Quaterniond& q = error.truth_from_estimate.rotation;
  return {{"translation", JsonOf(error.translation)},
          {"rotation", JsonOf(error.rotation)},
          {"truth_from_estimate",
           {{"translation", {p.x(), p.y(), p.z()}}, {"rotation", {q.x(), q.y(), q.z(), q.w()}}}}};
}

nlohmann::json JsonOf(const RelativeError& error) {
  return {{"length", error.length},
          {"count", error.count},
          {"translation", JsonOf(error.translation)},
          {"rotation", JsonOf(error.rotation)}};
}

template <typename... Numbers>
std::string Line(const char* format, Numbers... numbers) {
  char line[200];
  std::snprintf(line, sizeof line, format, numbers...);
  return line;
}

}  // namespace

void EvaluationOptions::Validate() const {
  Require(max_truth_gap > 0, ErrorCode::kUsage, "max_truth_gap must be > 0 s");
  for (const double length : segment_lengths)
    Require(length > 0, ErrorCode::kUsage, "segment_lengths must be > 0 m");
}

TrajectoryEvaluation EvaluateTrajectory(const std::vector<TimedPose>& truth,
                                        const std::vector<TimedPose>& estimate,
                                        const EvaluationOptions& options) {
  options.Validate();
  RequireIncreasingTimes(truth, "truth");
  RequireIncreasingTimes(estimate, "estimate");
  const Matches matches = Associate(truth, estimate, options.max_truth_gap);
  Require(matches.size() >= 3, ErrorCode::kInvalidInput,
          "only " + std::to_string(matches.size()) + " of " + std::to_string(estimate.size()) +
              " estimated poses have a true pose at their time; 3 are needed");

  TrajectoryEvaluation evaluation;
  evaluation.num_estimates = estimate.size();
  evaluation.num_matched = matches.size();
  evaluation.path_length = matches.traveled.back();
  evaluation.duration = matches.times.back() - matches.times.front();

  const Eigen::Matrix3Xd source = PositionsOf(matches.estimate);
  const Eigen::Matrix3Xd target = PositionsOf(matches.truth);
  const SimilarityAlignment alignment = AlignPoints(source, target);
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(source.cols());
  evaluation.rigid = AbsoluteAfter(alignment.target_from_source, matches);
  evaluation.yaw_only = AbsoluteAfter(AlignYawAndTranslation(source, target, ones, ones), matches);
  const Rigid3 by_poses =
      AlignPoints(BodiesOf(matches.estimate), BodiesOf(matches.truth)).target_from_source;
  evaluation.by_poses = AbsoluteAfter(by_poses, matches);
  evaluation.tilt =
      std::acos(std::clamp((by_poses.rotation * Eigen::Vector3d::UnitZ()).z(), -1.0, 1.0));
  // Scale means nothing below what noise alone would travel.
  if (evaluation.path_length > 1.0) {
    evaluation.drift_percent = 100 * evaluation.rigid.translation.rmse / evaluation.path_length;
    evaluation.scale = alignment.scale;
  }

  for (const double length : options.segment_lengths)
    evaluation.per_length.push_back(RelativeOver(length, matches.traveled, matches));
  std::vector<double> seconds;
  for (const Timestamp time : matches.times) seconds.push_back(time - matches.times.front());
  evaluation.per_second = RelativeOver(1.0, seconds, matches);
  return evaluation;
}

std::string ToText(const TrajectoryEvaluation& evaluation) {
  constexpr double kDegrees = 180 / M_PI;
  std::string text = Line("matched      %zu / %zu poses, %.2f m, %.2f s\n", evaluation.num_matched,
                          evaluation.num_estimates, evaluation.path_length, evaluation.duration);
  const auto absolute = [&](const char* name, const AbsoluteError& error) {
    text += Line("%-12s rmse %.4f m  mean %.4f  median %.4f  max %.4f   %.3f deg\n", name,
                 error.translation.rmse, error.translation.mean, error.translation.median,
                 error.translation.max, kDegrees * error.rotation.rmse);
  };
  absolute("ATE (6 DoF)", evaluation.rigid);
  absolute("ATE (4 DoF)", evaluation.yaw_only);
  text += Line("drift        %.3f %%   scale %.5f   tilt %.3f deg\n", evaluation.drift_percent,
               evaluation.scale, kDegrees * evaluation.tilt);
  const auto relative = [&](const RelativeError& error, const char* unit) {
    if (error.count == 0) return;
    text += Line("RPE %5.0f %-2s  rmse %.4f m  median %.4f  max %.4f   %.4f deg   (%zu)\n",
                 error.length, unit, error.translation.rmse, error.translation.median,
                 error.translation.max, kDegrees * error.rotation.rmse, error.count);
  };
  for (const RelativeError& error : evaluation.per_length) relative(error, "m");
  relative(evaluation.per_second, "s");
  return text;
}

nlohmann::json ToJson(const TrajectoryEvaluation& evaluation) {
  nlohmann::json per_length = nlohmann::json::array();
  for (const RelativeError& error : evaluation.per_length) per_length.push_back(JsonOf(error));
  return {{"num_estimates", evaluation.num_estimates},
          {"num_matched", evaluation.num_matched},
          {"path_length", evaluation.path_length},
          {"duration", evaluation.duration},
          {"rigid", JsonOf(evaluation.rigid)},
          {"yaw_only", JsonOf(evaluation.yaw_only)},
          {"by_poses", JsonOf(evaluation.by_poses)},
          {"tilt", evaluation.tilt},
          {"drift_percent", evaluation.drift_percent},
          {"scale", evaluation.scale},
          {"per_length", per_length},
          {"per_second", JsonOf(evaluation.per_second)}};
}

std::vector<TimedPose> PosesOf(const std::vector<TimedPose>& world_from_frame,
                               const Rigid3& frame_from_other) {
  std::vector<TimedPose> poses = world_from_frame;
  for (TimedPose& pose : poses) pose.world_from_frame = pose.world_from_frame * frame_from_other;
  return poses;
}

std::vector<TimedPose> ToTimedPoses(const Trajectory& trajectory) {
  std::vector<TimedPose> poses;
  poses.reserve(trajectory.states().size());
  for (const TrajectoryState& state : trajectory.states())
    poses.push_back({state.time, state.world_from_body});
  return poses;
}

}  // namespace parkade
