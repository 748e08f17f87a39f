#include "slam/knot_conditional.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>

#include "slam/smoother_window.h"

namespace parkade {
namespace {

constexpr size_t kMaxWindow = 128;  // knots; SmootherOptions allows fewer

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

using StateName = std::pair<std::int64_t, PriorBlock::Kind>;

/// Covariance of the states that the next conditional may speak of.
struct JointCovariance {
  std::vector<StateName> names;
  std::vector<Eigen::Index> columns;  // where each begins
  Eigen::MatrixXd matrix;

  void Append(const StateName& name) {
    columns.push_back(names.empty() ? 0 : columns.back() + SizeOf(names.back()));
    names.push_back(name);
  }
  static Eigen::Index SizeOf(const StateName& name) { return PriorBlock{name.second, name.first, {}}.TangentSize(); }
};

/// The part of `joint` about `names`; nothing when one is not in it.
std::optional<JointCovariance> Select(const JointCovariance& joint, const std::vector<StateName>& names) {
  JointCovariance selected;
  std::vector<Eigen::Index> from;
  for (const StateName& name : names) {
    const auto found = std::find(joint.names.begin(), joint.names.end(), name);
    if (found == joint.names.end()) return std::nullopt;
    const Eigen::Index begin = joint.columns[static_cast<size_t>(found - joint.names.begin())];
    for (Eigen::Index k = 0; k < JointCovariance::SizeOf(name); ++k) from.push_back(begin + k);
    selected.Append(name);
  }
  selected.matrix = joint.matrix(from, from);
  return selected;
}

/// The joint covariance of a knot and the rest of its conditional.
std::optional<JointCovariance> Extend(const KnotConditional& conditional, std::int64_t knot,
                                      const JointCovariance& joint) {
  std::vector<StateName> names;
  for (const PriorBlock& block : conditional.rest) names.emplace_back(block.knot, block.kind);
  const std::optional<JointCovariance> rest = Select(joint, names);
  if (!rest) return std::nullopt;
  const Eigen::MatrixXd own = conditional.own.cast<double>();
  const auto root = own.triangularView<Eigen::Upper>();
  const Eigen::MatrixXd gain = -root.solve(conditional.to_rest.cast<double>());
  const Eigen::MatrixXd inverse = root.solve(Eigen::MatrixXd::Identity(own.rows(), own.cols()));
  const Eigen::MatrixXd cross = gain * rest->matrix;

  JointCovariance extended;
  extended.Append({knot, PriorBlock::Kind::kPose});
  extended.Append({knot, PriorBlock::Kind::kMotion});
  for (const StateName& name : names) extended.Append(name);
  const Eigen::Index size = own.rows() + rest->matrix.rows();
  extended.matrix.resize(size, size);
  extended.matrix << inverse * inverse.transpose() + cross * gain.transpose(), cross, cross.transpose(), rest->matrix;
  if (!extended.matrix.allFinite()) return std::nullopt;
  return extended;
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

void SmoothOne(const KnotConditional& conditional, const std::map<std::int64_t, Values>& smoothed, double wheel_scale,
               MotionState& state) {
  const std::optional<Eigen::VectorXd> deviation = Deviation(conditional, smoothed, wheel_scale);
  if (!deviation) return;
  const Eigen::VectorXd right = -(conditional.offset.cast<double>() + conditional.to_rest.cast<double>() * *deviation);
  const Eigen::MatrixXd own = conditional.own.cast<double>();
  const Eigen::VectorXd change = own.triangularView<Eigen::Upper>().solve(right);
  MotionState corrected = state;
  if (change.allFinite()) Correct(change, corrected);
  if (corrected.IsFinite()) state = corrected;
}

}  // namespace

void SmoothBackwards(std::vector<FinishedKnot>& knots, double wheel_scale, const Eigen::MatrixXd& last_covariance) {
  if (knots.empty()) return;
  std::map<std::int64_t, Values> smoothed;  // of the knots that conditionals may speak of
  std::optional<JointCovariance> joint;
  if (last_covariance.rows() == 16) {
    joint.emplace();
    joint->Append({knots.back().number, PriorBlock::Kind::kPose});
    joint->Append({knots.back().number, PriorBlock::Kind::kMotion});
    joint->Append({-1, PriorBlock::Kind::kWheelScale});
    joint->matrix = last_covariance;
  }
  for (auto knot = knots.rbegin(); knot != knots.rend(); ++knot) {
    if (knot->conditional) {
      SmoothOne(*knot->conditional, smoothed, wheel_scale, knot->state);
      if (joint) joint = Extend(*knot->conditional, knot->number, *joint);
      knot->conditional.reset();
    }
    if (joint) knot->covariance = joint->matrix.topLeftCorner<6, 6>();
    smoothed[knot->number] = ValuesOf(knot->state);
    while (smoothed.size() > kMaxWindow) smoothed.erase(std::prev(smoothed.end()));
  }
}

}  // namespace parkade
