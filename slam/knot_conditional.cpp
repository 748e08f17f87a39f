#include "slam/knot_conditional.h"

#include <array>
#include <map>

#include "slam/smoother_window.h"

namespace parkade {
namespace {

struct Values {
  std::array<double, kPoseSize> pose{};
  std::array<double, kMotionSize> motion{};
};

Values ValuesOf(const MotionState& state) {
  Values values;
  PoseToParameters(state.odom_from_imu, values.pose.data());
  Eigen::Map<Eigen::Matrix<double, kMotionSize, 1>>(values.motion.data()) << state.velocity_in_odom,
      state.gyroscope_bias, state.accelerometer_bias;
  return values;
}

/// rest [-] at, or nothing when a state in it is not known.
std::optional<Eigen::VectorXd> Deviation(const KnotConditional& conditional,
                                         const std::map<std::int64_t, Values>& smoothed, double wheel_scale) {
  Eigen::VectorXd deviation(conditional.to_rest.cols());
  Eigen::Index column = 0;
  for (const PriorBlock& block : conditional.rest) {
    double* out = deviation.data() + column;
    column += block.TangentSize();
    if (block.kind == PriorBlock::Kind::kWheelScale) {
      *out = wheel_scale - block.at[0];
      continue;
    }
    const auto found = smoothed.find(block.knot);
    if (found == smoothed.end()) return std::nullopt;
    if (block.kind == PriorBlock::Kind::kPose)
      PoseManifold().Minus(found->second.pose.data(), block.at.data(), out);
    else
      for (size_t k = 0; k < kMotionSize; ++k) out[k] = found->second.motion[k] - block.at[k];
  }
  return deviation;
}

void Correct(const Eigen::VectorXd& change, MotionState& state) {
  state.odom_from_imu.rotation = (state.odom_from_imu.rotation * ExpSo3(change.head<3>())).normalized();
  state.odom_from_imu.translation += change.segment<3>(3);
  state.velocity_in_odom += change.segment<3>(6);
  state.gyroscope_bias += change.segment<3>(9);
  state.accelerometer_bias += change.segment<3>(12);
}

}  // namespace

void SmoothBackwards(std::vector<FinishedKnot>& knots, double wheel_scale) {
  std::map<std::int64_t, Values> smoothed;  // of the knots that conditionals may speak of
  for (auto knot = knots.rbegin(); knot != knots.rend(); ++knot) {
    if (knot->conditional) {
      const KnotConditional& conditional = *knot->conditional;
      if (const auto deviation = Deviation(conditional, smoothed, wheel_scale)) {
        const Eigen::VectorXd right =
            -(conditional.offset.cast<double>() + conditional.to_rest.cast<double>() * *deviation);
        const Eigen::MatrixXd own = conditional.own.cast<double>();
        const Eigen::VectorXd change = own.triangularView<Eigen::Upper>().solve(right);
        MotionState corrected = knot->state;
        if (change.allFinite()) Correct(change, corrected);
        if (corrected.IsFinite()) knot->state = corrected;
      }
      knot->conditional.reset();
    }
    smoothed[knot->number] = ValuesOf(knot->state);
    while (smoothed.size() > 128) smoothed.erase(std::prev(smoothed.end()));
  }
}

}  // namespace parkade
