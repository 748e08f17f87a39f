#include "tests/bench/odometry/pose_consistency.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace parkade {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;

/// Truth at a time; nothing outside.
std::optional<Rigid3> TruthAt(const std::vector<TimedPose>& truth, Timestamp time) {
  const auto after =
      std::lower_bound(truth.begin(), truth.end(), time,
                       [](const TimedPose& pose, Timestamp at) { return pose.time < at; });
  if (after == truth.end() || (after == truth.begin() && after->time != time)) return std::nullopt;
  if (after->time == time) return after->world_from_frame;
  const auto before = std::prev(after);
  return Interpolate(before->world_from_frame, after->world_from_frame,
                     (time - before->time) / (after->time - before->time));
}

/// The turn about the vertical that comes nearest to a rotation.
Eigen::Quaterniond YawOf(const Eigen::Quaterniond& rotation) {
  return Eigen::Quaterniond(rotation.w(), 0, 0, rotation.z()).normalized();
}

double Normalized(const Eigen::VectorXd& error, const Eigen::MatrixXd& covariance) {
  return error.dot(covariance.ldlt().solve(error)) / static_cast<double>(error.size());
}

}  // namespace

std::vector<PoseConsistency> MeasureConsistency(const Trajectory& odom_from_body,
                                                const std::vector<TimedPose>& truth,
                                                const Rigid3& body_from_imu,
                                                const std::vector<double>& shares) {
  std::vector<PoseConsistency> result;
  const std::vector<TrajectoryState>& states = odom_from_body.states();
  const TrajectoryState* start = nullptr;
  const auto variance = [](const TrajectoryState& state) {
    return state.covariance.diagonal().tail<3>().sum();
  };
  for (const TrajectoryState& state : states)
    if (variance(state) > 0 && (!start || variance(state) < variance(*start))) start = &state;
  if (!start) return result;
  const std::optional<Rigid3> true_start = TruthAt(truth, start->time);
  if (!true_start) return result;
  Rigid3 odom_from_world;
  odom_from_world.rotation =
      YawOf(start->world_from_body.rotation * true_start->rotation.conjugate());
  odom_from_world.translation =
      start->world_from_body * body_from_imu.translation -
      odom_from_world.rotation * (*true_start * body_from_imu.translation);
  for (const double share : shares) {
    const double length = states.back().time - start->time;
    const auto found =
        std::find_if(states.begin(), states.end(), [&](const TrajectoryState& state) {
          return state.time - start->time >= share * length - 1e-6;
        });
    if (found == states.end()) continue;
    const std::optional<Rigid3> true_pose = TruthAt(truth, found->time);
    if (!true_pose) continue;
    const Rigid3 expected = odom_from_world * *true_pose;
    Vector6 error;
    error << LogSo3(found->world_from_body.rotation.conjugate() * expected.rotation),
        expected.translation - found->world_from_body.translation;
    const auto& covariance = found->covariance;
    result.push_back({found->time - start->time, Normalized(error, covariance),
                      Normalized(error.head<3>(), covariance.topLeftCorner<3, 3>()),
                      Normalized(error.tail<3>(), covariance.bottomRightCorner<3, 3>()),
                      error.head<3>().norm(), error.tail<3>().norm()});
  }
  return result;
}

ConfidenceBounds BoundsOfMean(int num_runs, int freedom) {
  const double total = std::max(1, num_runs * freedom), spread = 2 / (9 * total);
  const auto quantile = [&](double normal) {
    return std::pow(1 - spread + normal * std::sqrt(spread), 3);
  };
  return {quantile(-1.959964), quantile(1.959964)};
}

}  // namespace parkade
