#include "tests/simulator/motion/motion.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace parkade::simulator {
namespace {

constexpr int kPadding = 4;  // control points beyond each end

using Weights = std::array<double, 6>;

/// Cardinal B-spline of `degree` with support [0, degree + 1], by Cox-de Boor.
double CardinalSpline(int degree, double x) {
  if (x < 0 || x >= degree + 1) return 0;
  if (degree == 0) return 1;
  return (x * CardinalSpline(degree - 1, x) +
          (degree + 1 - x) * CardinalSpline(degree - 1, x - 1)) /
         degree;
}

/// Polynomial coefficients of the six quintic basis functions on one interval,
/// by the recursion on the fraction u; row = control point, column = power of u.
Eigen::Matrix<double, 6, 6> BasisCoefficients() {
  Eigen::Matrix<double, 6, 6> samples, powers;
  for (int i = 0; i < 6; ++i) {
    const double u = i / 6.0;
    for (int k = 0; k < 6; ++k) {
      samples(k, i) = CardinalSpline(5, u + 5 - k);
      powers(k, i) = std::pow(u, k);
    }
  }
  return powers.transpose().partialPivLu().solve(samples.transpose()).transpose();
}

/// Weights of the control points for the `derivative`-th derivative by u.
Weights WeightsAt(double u, int derivative) {
  static const Eigen::Matrix<double, 6, 6> coefficients = BasisCoefficients();
  Eigen::Matrix<double, 6, 1> powers = Eigen::Matrix<double, 6, 1>::Zero();
  for (int power = derivative; power < 6; ++power) {
    double factor = 1;
    for (int k = 0; k < derivative; ++k) factor *= power - k;
    powers[power] = factor * std::pow(u, power - derivative);
  }
  const Eigen::Matrix<double, 6, 1> weights = coefficients * powers;
  Weights result;
  Eigen::Map<Eigen::Matrix<double, 6, 1>>(result.data()) = weights;
  return result;
}

Eigen::Quaterniond RotationOf(const PoseVector& pose) {
  return Eigen::AngleAxisd(pose[3], Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(pose[4], Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(pose[5], Eigen::Vector3d::UnitX());
}

/// Angular velocity in body and its derivative from the angles' rates. With
/// R = Rz(yaw) Ry(pitch) Rx(roll): w = (roll' - yaw' sin p, pitch' cos r + yaw' cos p sin r,
/// -pitch' sin r + yaw' cos p cos r).
void SetAngularMotion(const PoseVector& pose, const PoseVector& rate, const PoseVector& second,
                      MotionState& state) {
  const double cp = std::cos(pose[4]), sp = std::sin(pose[4]), cr = std::cos(pose[5]),
               sr = std::sin(pose[5]);
  const double yaw1 = rate[3], pitch1 = rate[4], roll1 = rate[5];
  const double yaw2 = second[3], pitch2 = second[4], roll2 = second[5];
  state.angular_velocity_in_body << roll1 - yaw1 * sp, pitch1 * cr + yaw1 * cp * sr,
      -pitch1 * sr + yaw1 * cp * cr;
  state.angular_acceleration_in_body << roll2 - yaw2 * sp - yaw1 * cp * pitch1,
      pitch2 * cr - pitch1 * sr * roll1 + yaw2 * cp * sr - yaw1 * sp * pitch1 * sr +
          yaw1 * cp * cr * roll1,
      -pitch2 * sr - pitch1 * cr * roll1 + yaw2 * cp * cr - yaw1 * sp * pitch1 * cr -
          yaw1 * cp * sr * roll1;
}

}  // namespace

Motion::Motion(const std::function<PoseVector(double)>& pose_at, double duration,
               double node_distance)
    : duration_(duration), node_distance_(node_distance) {
  const int num_nodes = static_cast<int>(std::ceil(duration / node_distance)) + 1;
  std::vector<PoseVector> samples;
  for (int i = -kPadding - 1; i < num_nodes + kPadding + 1; ++i)
    samples.push_back(pose_at(i * node_distance));
  // Quasi-interpolation: the spline of control points f - f''h^2/4 meets f to fourth order.
  for (size_t i = 1; i + 1 < samples.size(); ++i)
    control_points_.push_back(samples[i] -
                              0.25 * (samples[i - 1] - 2 * samples[i] + samples[i + 1]));
}

MotionState Motion::At(double time) const {
  const double place = std::clamp(time, 0.0, duration_) / node_distance_;
  const int node = static_cast<int>(place);
  const double u = place - node;
  // Control point k peaks at its node; the interval [node, node + 1] is moved by nodes -2 .. +3
  // about it.
  const size_t first = static_cast<size_t>(node - 2 + kPadding);
  std::array<PoseVector, 3> derivatives;
  for (int order = 0; order < 3; ++order) {
    const Weights weights = WeightsAt(u, order);
    derivatives[static_cast<size_t>(order)].setZero();
    for (size_t k = 0; k < 6; ++k)
      derivatives[static_cast<size_t>(order)] += weights[k] * control_points_[first + k];
    derivatives[static_cast<size_t>(order)] /= std::pow(node_distance_, order);
  }
  MotionState state;
  state.world_from_body = {RotationOf(derivatives[0]), derivatives[0].head<3>()};
  state.velocity_in_world = derivatives[1].head<3>();
  state.acceleration_in_world = derivatives[2].head<3>();
  SetAngularMotion(derivatives[0], derivatives[1], derivatives[2], state);
  return state;
}

Rigid3 Motion::WorldFromBody(double time) const { return At(time).world_from_body; }

}  // namespace parkade::simulator
