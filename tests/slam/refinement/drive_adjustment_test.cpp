#include "slam/refinement/drive_adjustment.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/slam/worlds/noded_drive.h"

namespace parkade {
namespace {

/// A drive of 8 s with two cameras, measured without bias.
struct MeasuredDrive {
  NodedDrive drive{{.seed = 4,
                    .duration = 8,
                    .start = 12,
                    .camera_rate = 10,
                    .num_cameras = 2,
                    .wheel_scale = 1,
                    .gyroscope_bias = 0,
                    .accelerometer_bias = 0,
                    .outliers = 0}};
  std::unique_ptr<DriveMeasurements> measurements = drive.Measure();

  std::vector<MotionState> Truth() const {
    std::vector<MotionState> states;
    for (int node = 0; node < drive.num_nodes(); ++node) states.push_back(drive.TruthAt(node));
    return states;
  }

  /// The truth, all nodes but the first off by 1 cm, 0.06 degrees and 0.1 m/s per axis: about as
  /// far as rays may be apart to become a landmark.
  std::vector<MotionState> Disturbed() const {
    std::mt19937 random(9);
    std::normal_distribution<double> normal;
    const auto draw = [&](double sigma) {
      const double x = normal(random), y = normal(random), z = normal(random);
      return Eigen::Vector3d(sigma * x, sigma * y, sigma * z);
    };
    std::vector<MotionState> states = Truth();
    for (size_t i = 1; i < states.size(); ++i) {
      Rigid3& pose = states[i].odom_from_imu;
      pose = {(pose.rotation * ExpSo3(draw(0.001))).normalized(), pose.translation + draw(0.01)};
      states[i].velocity_in_odom += draw(0.1);
    }
    return states;
  }

  /// [m] rms of position over all nodes.
  double ErrorOf(const std::vector<MotionState>& states) const {
    return DistanceBetween(states, Truth());
  }

  static double DistanceBetween(const std::vector<MotionState>& a,
                                const std::vector<MotionState>& b) {
    double sum = 0;
    for (size_t i = 0; i < a.size(); ++i)
      sum += (a[i].odom_from_imu.translation - b[i].odom_from_imu.translation).squaredNorm();
    return std::sqrt(sum / static_cast<double>(a.size()));
  }
};

const MeasuredDrive& Measured() {
  static const MeasuredDrive measured;
  return measured;
}

TEST(DriveAdjustment, ADisturbedStartEndsWhereTheTruthDoes) {
  const MeasuredDrive& measured = Measured();
  const std::vector<MotionState> start = measured.Disturbed();
  DriveAdjustment adjustment(*measured.measurements, measured.drive.rig(), start, {});
  DriveAdjustment from_truth(*measured.measurements, measured.drive.rig(), measured.Truth(), {});

  const int steps = adjustment.Solve({0, adjustment.num_nodes(), false, true}, {40});
  from_truth.Solve({0, from_truth.num_nodes(), false, true}, {40});

  EXPECT_GT(steps, 1);
  EXPECT_GT(measured.ErrorOf(start), 0.014) << "[m]";
  EXPECT_LT(measured.DistanceBetween(adjustment.States(), from_truth.States()), 0.005) << "[m]";
  EXPECT_LT(measured.ErrorOf(from_truth.States()), 0.06) << "[m], as far as noise takes it";
  EXPECT_LT((adjustment.States().front().odom_from_imu.translation -
             start.front().odom_from_imu.translation)
                .norm(),
            1e-4)
      << "[m]: the first node keeps its place";
}

TEST(DriveAdjustment, TheErrorOfHeldOutTracksFalls) {
  const MeasuredDrive& measured = Measured();
  DriveAdjustment adjustment(*measured.measurements, measured.drive.rig(), measured.Disturbed(),
                             {});
  adjustment.HoldOutLandmarks(5);
  adjustment.FitLandmarks();
  const AdjustmentStatistics before = adjustment.Statistics();

  adjustment.Solve({0, adjustment.num_nodes(), false, true}, {20});
  adjustment.FitLandmarks();

  const AdjustmentStatistics after = adjustment.Statistics();
  ASSERT_GT(after.num_landmarks, 50u);
  EXPECT_LT(after.unused_bearings, 0.8 * before.unused_bearings);
  EXPECT_LT(after.imu, 2) << "as large as the IMU's noise";
  EXPECT_GT(before.imu, 100);
}

TEST(DriveAdjustment, NodesOutsideTheStretchStay) {
  const MeasuredDrive& measured = Measured();
  const std::vector<MotionState> start = measured.Disturbed();
  DriveAdjustment adjustment(*measured.measurements, measured.drive.rig(), start, {});

  adjustment.Solve({10, 20, false, false}, {5});

  const std::vector<MotionState> after = adjustment.States();
  EXPECT_EQ(after[9].odom_from_imu.translation, start[9].odom_from_imu.translation);
  EXPECT_EQ(after[20].odom_from_imu.translation, start[20].odom_from_imu.translation);
  EXPECT_NE(after[15].odom_from_imu.translation, start[15].odom_from_imu.translation);
  EXPECT_EQ(adjustment.WheelScale(), 0);
}

TEST(DriveAdjustment, ThePosesAreAsCertainAsTheyAreRight) {
  const MeasuredDrive& measured = Measured();
  DriveAdjustment adjustment(*measured.measurements, measured.drive.rig(), measured.Truth(), {});
  adjustment.Solve({0, adjustment.num_nodes(), false, true}, {20});

  const size_t last = adjustment.num_nodes() - 1;
  const std::optional<Eigen::MatrixXd> covariance = adjustment.PoseCovariance({0, last});

  ASSERT_TRUE(covariance);
  EXPECT_LT(std::sqrt(covariance->block<3, 3>(3, 3).trace()), 1e-4) << "[m]";
  const double sigma = std::sqrt(covariance->block<3, 3>(9, 9).trace());
  EXPECT_GT(sigma, 0.002) << "[m]";
  EXPECT_LT(sigma, 0.3) << "[m]";
}

}  // namespace
}  // namespace parkade
