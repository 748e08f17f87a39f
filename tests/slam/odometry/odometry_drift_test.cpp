#include "slam/odometry/odometry_drift.h"

#include <gtest/gtest.h>

namespace parkade {
namespace {

/// 100 m straight on, with roll as on a slope across; covariance of the last pose as given.
Trajectory StraightDrive(const Eigen::Matrix<double, 6, 6>& covariance) {
  std::vector<TrajectoryState> states;
  for (int i = 0; i <= 100; ++i) {
    TrajectoryState& state = states.emplace_back();
    state.time = TimestampFromSeconds(i);
    state.world_from_body = {ExpSo3({0.5, 0, 0}), Eigen::Vector3d(i, 0, 0)};
  }
  states.back().covariance = covariance;
  return Trajectory(std::move(states));
}

TEST(OdometryDrift, IsTheRandomWalkThatEndsWithTheCovariance) {
  const Eigen::Vector3d up_in_body = ExpSo3({0.5, 0, 0}).conjugate() * Eigen::Vector3d::UnitZ();
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  covariance.topLeftCorner<3, 3>() =
      1e-4 * up_in_body * up_in_body.transpose();  // 0.01 rad of yaw alone
  covariance.bottomRightCorner<3, 3>() = 0.09 * Eigen::Matrix3d::Identity();  // 0.3 m

  const OdometryDrift drift = DriftOf(StraightDrive(covariance));

  EXPECT_NEAR(drift.yaw, 0.001, 1e-9) << "[rad / sqrt(m)]: 0.01 rad after 100 m";
  EXPECT_NEAR(drift.translation, 0.03, 1e-9) << "[m / sqrt(m)]: 0.3 m after 100 m";
}

TEST(OdometryDrift, OfWhatHasNoCovarianceOrNeverMovedIsUnknown) {
  const OdometryDrift without = DriftOf(StraightDrive(Eigen::Matrix<double, 6, 6>::Zero()));
  EXPECT_EQ(without.yaw, 0);
  EXPECT_EQ(without.translation, 0);
  EXPECT_EQ(DriftOf(Trajectory()).yaw, 0);
}

}  // namespace
}  // namespace parkade
