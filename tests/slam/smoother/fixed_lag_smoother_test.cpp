#include "slam/smoother/fixed_lag_smoother.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/slam/worlds/noded_drive.h"

namespace parkade {
namespace {

constexpr double kDegree = M_PI / 180;

SampledDriveOptions RollingDrive() {
  return {.seed = 5,
          .duration = 10,
          .start = 12,
          .camera_rate = 10,
          .num_cameras = 2,
          .wheel_scale = 1.005,
          .outliers = 0};
}

/// The first state, tilted and slowed as a start may be.
MotionState RoughStart(const NodedDrive& drive) {
  MotionState start = drive.TruthAt(0);
  start.odom_from_imu.rotation =
      (ExpSo3({0.02, -0.02, 0}) * start.odom_from_imu.rotation).normalized();
  start.velocity_in_odom += Eigen::Vector3d(0.15, -0.1, 0.05);
  return start;
}

/// Feeds the drive to a smoother that starts in `start`; calls `finished` with each node that left.
template <typename Finished>
void Feed(const NodedDrive& drive, const MotionState& start, FixedLagSmoother& smoother,
          const Finished& finished) {
  smoother.Start(start, {}, {});
  for (int node = 1; node < drive.num_nodes(); ++node) {
    const MotionState last = smoother.Latest();
    NodeInterval interval =
        drive.IntervalBefore(node, {last.gyroscope_bias, last.accelerometer_bias});
    std::vector<NewImage> images = drive.ImagesBefore(node, interval, last.odom_from_imu.rotation);
    smoother.AddNode(std::move(interval), std::move(images));
    smoother.Solve();
    for (const FinishedNode& left : smoother.DropOldest()) finished(left);
  }
}

TEST(FixedLagSmoother, ARoughStartConvergesToTheTruth) {
  const NodedDrive drive(RollingDrive());
  const MotionState start = RoughStart(drive);
  FixedLagSmoother smoother(drive.rig(), {});

  Feed(drive, start, smoother, [](const FinishedNode&) {});

  const MotionState truth = drive.TruthAt(drive.num_nodes() - 1), latest = smoother.Latest();
  const Eigen::Vector3d up = latest.odom_from_imu.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d true_up =
      truth.odom_from_imu.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  EXPECT_LT(up.cross(true_up).norm(), 0.3 * kDegree) << "tilted by 1.6 degrees at the start";
  EXPECT_LT((latest.velocity_in_odom - truth.velocity_in_odom).norm(), 0.1) << "[m/s]";
  EXPECT_LT((latest.odom_from_imu.translation - truth.odom_from_imu.translation).norm(), 0.4)
      << "[m] after some 40 m";
  EXPECT_NEAR(smoother.wheel_scale(), 0.005, 0.005);
}

TEST(FixedLagSmoother, NodesLeaveInOrderWithACovarianceAndWhatTheRestSaysOfThem) {
  const NodedDrive drive(RollingDrive());
  FixedLagSmoother smoother(drive.rig(), {});
  std::vector<FinishedNode> left;

  Feed(drive, drive.TruthAt(0), smoother, [&](const FinishedNode& node) { left.push_back(node); });
  EXPECT_EQ(smoother.nodes().size(), 16u);
  for (FinishedNode& node : smoother.Finish()) left.push_back(std::move(node));

  ASSERT_EQ(left.size(), static_cast<size_t>(drive.num_nodes()));
  for (size_t i = 0; i < left.size(); ++i) {
    EXPECT_EQ(left[i].number, static_cast<std::int64_t>(i));
    EXPECT_EQ(left[i].interval.has_value(), i > 0);
    EXPECT_EQ(left[i].conditionals.own.has_value(), i + 1 < left.size());
    EXPECT_TRUE(left[i].covariance.allFinite());
  }
  EXPECT_GT(left.back().covariance(3, 3), left[1].covariance(3, 3)) << "position drifts";
  EXPECT_GT(smoother.TakeLandmarks().size(), 50u);
}

TEST(FixedLagSmoother, WithoutImagesImuAndWheelsCarryOn) {
  SampledDriveOptions options = RollingDrive();
  options.tracks = 0;
  options.duration = 5;
  const NodedDrive drive(options);
  FixedLagSmoother smoother(drive.rig(), {});

  Feed(drive, drive.TruthAt(0), smoother, [](const FinishedNode&) {});

  const MotionState truth = drive.TruthAt(drive.num_nodes() - 1);
  EXPECT_LT((smoother.Latest().odom_from_imu.translation - truth.odom_from_imu.translation).norm(),
            1.0)
      << "[m] after some 20 m";
}

TEST(FixedLagSmoother, TheSameDriveGivesTheSameBytes) {
  SampledDriveOptions options = RollingDrive();
  options.duration = 5;
  const NodedDrive drive(options);
  FixedLagSmoother first(drive.rig(), {}), second(drive.rig(), {});

  Feed(drive, RoughStart(drive), first, [](const FinishedNode&) {});
  Feed(drive, RoughStart(drive), second, [](const FinishedNode&) {});

  EXPECT_EQ(first.Latest().odom_from_imu.translation, second.Latest().odom_from_imu.translation);
  EXPECT_EQ(first.wheel_scale(), second.wheel_scale());
}

TEST(FixedLagSmoother, RefusesAWindowOfTwoNodes) {
  SmootherOptions options;
  options.window_nodes = 2;
  EXPECT_THROW(FixedLagSmoother(NodedDrive({.duration = 1}).rig(), options), Error);
}

}  // namespace
}  // namespace parkade
