#include "slam/refinement/covariance_modes.h"

#include <algorithm>

#include "core/math/decompositions.h"

namespace parkade {
namespace {

constexpr double kLever = 5;       // [m] at which a rotation counts as what it moves
constexpr double kLeftOut = 1e-3;  // [m] rms per pose

}  // namespace

Eigen::MatrixXd CovarianceModes::At(Timestamp time) const {
  const auto after = std::lower_bound(times.begin(), times.end(), time);
  const auto rows = [this](auto at) { return modes.middleRows<6>(6 * (at - times.begin())); };
  if (after == times.begin()) return rows(after);
  if (after == times.end()) return rows(after - 1);
  const double fraction = (time - *(after - 1)) / (*after - *(after - 1));
  return (1 - fraction) * rows(after - 1) + fraction * rows(after);
}

CovarianceModes FindCovarianceModes(std::vector<Timestamp> times,
                                    const Eigen::MatrixXd& covariance) {
  const Eigen::Index count = covariance.rows();
  Eigen::VectorXd scale(count);
  for (Eigen::Index i = 0; i < count; ++i) scale[i] = i % 6 < 3 ? kLever : 1;
  const SymmetricEigen eigen =
      DecomposeSymmetric(scale.asDiagonal() * covariance * scale.asDiagonal());
  const Eigen::VectorXd& variances = eigen.values;
  const double bound = kLeftOut * kLeftOut * static_cast<double>(times.size());
  Eigen::Index left_out = 0;
  for (double sum = 0; left_out < count; ++left_out) {
    sum += std::max(variances[left_out], 0.0);
    if (sum > bound) break;
  }
  const Eigen::Index kept = count - left_out;
  CovarianceModes result;
  result.times = std::move(times);
  result.modes = scale.cwiseInverse().asDiagonal() * eigen.vectors.rightCols(kept) *
                 variances.tail(kept).cwiseSqrt().asDiagonal();
  return result;
}

Trajectory WithCovariances(const Trajectory& odom_from_body, const CovarianceModes& modes) {
  std::vector<TrajectoryState> states = odom_from_body.states();
  for (TrajectoryState& state : states) {
    Eigen::MatrixXd at = modes.At(state.time);
    at.topRows<3>() =
        (state.world_from_body.rotation.conjugate().toRotationMatrix() * at.topRows<3>()).eval();
    state.covariance = at * at.transpose();
  }
  return Trajectory(std::move(states));
}

Rigid3 Bent(const Rigid3& pose, const Eigen::Matrix<double, 6, 1>& error) {
  return {(ExpSo3(error.head<3>()) * pose.rotation).normalized(),
          pose.translation + error.tail<3>()};
}

}  // namespace parkade
