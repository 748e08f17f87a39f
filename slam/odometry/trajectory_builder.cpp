#include "slam/odometry/trajectory_builder.h"

#include <algorithm>
#include <cmath>

namespace parkade {
namespace {

ImuBias BiasOf(const MotionState& state) {
  return {state.gyroscope_bias, state.accelerometer_bias};
}

}  // namespace

TrajectoryBuilder::TrajectoryBuilder(const Rig& rig, double output_interval)
    : imu_from_body_(rig.body_from_imu.Inverse()), output_interval_(output_interval) {}

TrajectoryState TrajectoryBuilder::ToBody(const MotionState& state,
                                          const Eigen::Vector3d& angular_velocity,
                                          const Eigen::Matrix<double, 6, 6>& covariance) const {
  TrajectoryState body;
  body.time = state.time;
  body.world_from_body = state.odom_from_imu * imu_from_body_;
  const Eigen::Vector3d rate = angular_velocity - state.gyroscope_bias;
  body.velocity_in_world = state.velocity_in_odom +
                           state.odom_from_imu.rotation * rate.cross(imu_from_body_.translation);
  body.gyroscope_bias = state.gyroscope_bias;
  body.accelerometer_bias = state.accelerometer_bias;
  // d body = (R_BI d rotation, d position - R [l]x d rotation).
  Eigen::Matrix<double, 6, 6> by_imu = Eigen::Matrix<double, 6, 6>::Identity();
  by_imu.topLeftCorner<3, 3>() = imu_from_body_.rotation.toRotationMatrix().transpose();
  by_imu.bottomLeftCorner<3, 3>() =
      -state.odom_from_imu.rotation.toRotationMatrix() * Skew(imu_from_body_.translation);
  body.covariance = by_imu * covariance * by_imu.transpose();
  return body;
}

void TrajectoryBuilder::Add(const RecordedNode& node, const std::optional<NodeInterval>& interval) {
  if (!first_) first_ = node.state;
  if (last_ && interval) AddBetween(*last_, node, *interval);
  const Eigen::Vector3d rate =
      interval ? interval->imu.samples().back().angular_velocity : node.state.gyroscope_bias;
  states_.push_back(ToBody(node.state, rate, node.covariance));
  last_ = node.state;
}

void TrajectoryBuilder::AddBetween(const MotionState& first, const RecordedNode& second,
                                   const NodeInterval& interval) {
  const std::vector<ImuSample>& samples = interval.imu.samples();
  const ImuBias bias = BiasOf(first);
  const MotionIncrement whole = Integrate(samples, bias);
  const Eigen::Vector3d velocity_error =
      second.state.velocity_in_odom - Propagate(first, whole).velocity_in_odom;
  const int pieces = static_cast<int>(std::ceil(whole.duration / output_interval_ - 1e-9));
  MotionIncrement part;
  size_t next = 1;
  ImuSample at = samples.front();
  for (int k = 1; k < pieces; ++k) {
    const Timestamp time = first.time + whole.duration * k / pieces;
    for (; next < samples.size() && samples[next].time <= time; ++next) {
      if (samples[next].time > at.time) Advance(part, at, samples[next], bias);
      at = samples[next];
    }
    if (at.time < time && next < samples.size()) {
      const ImuSample middle = InterpolateSamples(at, samples[next], time);
      Advance(part, at, middle, bias);
      at = middle;
    }
    const NodeInterpolation shape =
        MakeNodeInterpolation(part, whole, first.odom_from_imu.rotation);
    MotionState state = Propagate(first, part);
    state.time = time;
    state.velocity_in_odom += shape.fraction * velocity_error;
    state.odom_from_imu = shape.At(first.odom_from_imu, second.state.odom_from_imu);
    if (interval.is_still) {
      state.odom_from_imu =
          Interpolate(first.odom_from_imu, second.state.odom_from_imu, shape.fraction);
      state.velocity_in_odom = second.state.velocity_in_odom;
    }
    states_.push_back(ToBody(state, at.angular_velocity, second.covariance));
  }
}

std::vector<TrajectoryState> TrajectoryBuilder::StatesBefore(const EarlyRecords& early,
                                                             bool is_still) const {
  ImuBuffer imu;
  for (const ImuSample& sample : early.imu) imu.Add(sample);
  WheelBuffer wheels;
  for (const WheelSample& sample : early.wheels) wheels.Add(sample);
  std::vector<TrajectoryState> states;
  if (!first_ || imu.empty() || imu.front().time >= first_->time) return states;
  const std::vector<ImuSample> samples = imu.Between(imu.front().time, first_->time);
  const Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  MotionState state = *first_;
  Timestamp last_output = state.time;
  for (size_t k = samples.size() - 1; k > 0; --k) {
    MotionIncrement step;
    Advance(step, samples[k - 1], samples[k], BiasOf(state));
    MotionState before = PropagateBack(state, step);
    before.time = samples[k - 1].time;
    const auto velocity_on_wheels = [&](const ImuSample& sample,
                                        const MotionState& at) -> Eigen::Vector3d {
      const Eigen::Vector3d rate = sample.angular_velocity - at.gyroscope_bias;
      return at.odom_from_imu.rotation *
             (imu_from_body_.rotation *
                  Eigen::Vector3d(wheels.At(sample.time).forward_speed, 0, 0) -
              rate.cross(imu_from_body_.translation));
    };
    if (is_still) {
      before.odom_from_imu = state.odom_from_imu;
      before.velocity_in_odom.setZero();
    } else if (!wheels.empty() && wheels.LongestGap(before.time, state.time) < kMaxWheelGap) {
      before.velocity_in_odom = velocity_on_wheels(samples[k - 1], before);
      before.odom_from_imu.translation =
          state.odom_from_imu.translation -
          0.5 * step.duration * (before.velocity_in_odom + velocity_on_wheels(samples[k], state));
    }
    state = before;
    if (last_output - state.time >= 0.5 * output_interval_ || k == 1) {
      states.push_back(ToBody(state, samples[k - 1].angular_velocity, covariance));
      last_output = state.time;
    }
  }
  std::reverse(states.begin(), states.end());
  return states;
}

std::vector<TrajectoryState> TrajectoryBuilder::Take() { return std::exchange(states_, {}); }

}  // namespace parkade
