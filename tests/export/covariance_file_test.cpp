#include "export/covariance_file.h"

#include <gtest/gtest.h>

#include <sstream>

#include "export/trajectory_files.h"
#include "tests/export/example_map.h"

namespace parkade {
namespace {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

struct Row {
  Timestamp time;
  Matrix6d covariance;
  Eigen::Vector4d site;
};

std::vector<Row> Parse(const std::string& csv) {
  std::vector<Row> rows;
  std::istringstream text(csv);
  std::string line, field;
  std::getline(text, line);
  while (std::getline(text, line)) {
    std::istringstream fields(line);
    std::getline(fields, field, ',');
    Row& row = rows.emplace_back();
    row.time = ParseSeconds(field);
    for (int i = 0; i < 6; ++i)
      for (int k = i; k < 6; ++k) {
        std::getline(fields, field, ',');
        row.covariance(i, k) = row.covariance(k, i) = std::stod(field);
      }
    for (int i = 0; i < 4; ++i) {
      std::getline(fields, field, ',');
      row.site[i] = std::stod(field);
    }
    EXPECT_FALSE(std::getline(fields, field, ','));
  }
  return rows;
}

/// A drive whose IMU is turned and away from the body, in an odometry frame that is turned against
/// the site.
SiteDrive TurnedDrive() {
  SiteDrive drive = MakeMapWithoutGround().drives[0];
  drive.rig.body_from_imu.rotation = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized());
  drive.odometry = drive.odometry.Transformed(
      {Eigen::Quaterniond(Eigen::AngleAxisd(2, Eigen::Vector3d::UnitZ())), {50, 20, 1}});
  return drive;
}

TEST(CovarianceFile, IsOfTheImuAsSmallErrorsOfTheBodyMoveIt) {
  const SiteDrive drive = TurnedDrive();
  const std::vector<Row> rows = Parse(EncodeCovarianceCsv(drive, std::nullopt));
  ASSERT_GT(rows.size(), 250U);

  const std::vector<TimedPose> poses = SampleFinalTrajectory(drive);
  int num_compared = 0;
  for (const Row& row : rows) {
    const auto& states = drive.site_from_body_trajectory.states();
    const auto state =
        std::find_if(states.begin(), states.end(),
                     [&](const TrajectoryState& candidate) { return candidate.time == row.time; });
    if (state == states.end()) continue;
    const auto pose = std::find_if(poses.begin(), poses.end(), [&](const TimedPose& candidate) {
      return candidate.time == row.time;
    });
    constexpr double kStep = 1e-6;
    Matrix6d numeric;
    for (int column = 0; column < 6; ++column) {
      Vector6d step = Vector6d::Zero();
      step[column] = kStep;
      Rigid3 moved = pose->world_from_frame * drive.rig.body_from_imu.Inverse();
      moved.rotation = moved.rotation * ExpSo3(step.head<3>());
      moved.translation += step.tail<3>();
      const Rigid3 imu = moved * drive.rig.body_from_imu;
      numeric.col(column) << LogSo3(pose->world_from_frame.rotation.conjugate() * imu.rotation) /
                                 kStep,
          (imu.translation - pose->world_from_frame.translation) / kStep;
    }
    const Matrix6d expected = numeric * state->covariance * numeric.transpose();
    EXPECT_LT((row.covariance - expected).norm(), 1e-4 * expected.norm())
        << "after " << num_compared;
    ++num_compared;
  }
  EXPECT_GT(num_compared, 50);
}

TEST(CovarianceFile, IsThatOfTheFinalStates) {
  SiteDrive drive = MakeMapWithoutGround().drives[0];
  std::vector<TrajectoryState> states = drive.site_from_body_trajectory.states();
  for (TrajectoryState& state : states) state.covariance *= 4;
  SiteDrive doubtful = drive;
  doubtful.site_from_body_trajectory = Trajectory(states);
  const Row row = Parse(EncodeCovarianceCsv(drive, std::nullopt)).back();
  const Row of_doubtful = Parse(EncodeCovarianceCsv(doubtful, std::nullopt)).back();
  EXPECT_LT((of_doubtful.covariance - 4 * row.covariance).norm(), 1e-4 * row.covariance.norm());
}

TEST(CovarianceFile, TellsHowSureTheSiteIsOnlyWhereItLiesOnEarth) {
  const SiteDrive drive = TurnedDrive();
  SitePlacement placement;
  placement.covariance.diagonal() << 1e-4, 0.04, 0.09, 0.25;
  const Row placed = Parse(EncodeCovarianceCsv(drive, placement)).back();
  const Row relative = Parse(EncodeCovarianceCsv(drive, std::nullopt)).back();

  const Eigen::Vector3d position = SampleFinalTrajectory(drive).back().world_from_frame.translation;
  EXPECT_NEAR(placed.site[0], std::sqrt(0.04 + 1e-4 * position.y() * position.y()), 1e-3);
  EXPECT_NEAR(placed.site[1], std::sqrt(0.09 + 1e-4 * position.x() * position.x()), 1e-3);
  EXPECT_NEAR(placed.site[2], 0.5, 1e-6);
  EXPECT_NEAR(placed.site[3], 0.01, 1e-6);
  EXPECT_TRUE(relative.site.array().isNaN().all());
}

TEST(CovarianceFile, ADriveWithoutOdometryHasTheHeaderOnly) {
  const std::string csv = EncodeCovarianceCsv({}, std::nullopt);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1);
}

}  // namespace
}  // namespace parkade
