#include "core/trajectory.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "core/error.h"

namespace parkade {
namespace {

TrajectoryState StateAt(double seconds, double x, double yaw) {
  TrajectoryState state;
  state.time = TimestampFromSeconds(seconds);
  state.world_from_body = {Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ())),
                           {x, 0, 0}};
  state.velocity_in_world = {1, 0, 0};
  state.covariance.diagonal() << 1, 2, 3, 4, 5, 6;
  return state;
}

const Trajectory kDrive({StateAt(10, 0, 0), StateAt(11, 1, 0.2), StateAt(13, 3, 0.2)});

TEST(Trajectory, InterpolatesInsideAndGivesNothingOutside) {
  const Rigid3 middle = kDrive.At(TimestampFromSeconds(10.5)).value();
  EXPECT_NEAR(middle.translation.x(), 0.5, 1e-12);
  EXPECT_NEAR(LogSo3(middle.rotation).z(), 0.1, 1e-12);
  EXPECT_NEAR(kDrive.At(TimestampFromSeconds(13)).value().translation.x(), 3, 1e-12);
  EXPECT_NEAR(kDrive.At(TimestampFromSeconds(10)).value().translation.x(), 0, 1e-12);
  EXPECT_FALSE(kDrive.At(TimestampFromSeconds(13) + 1e-9));
  EXPECT_FALSE(kDrive.At(TimestampFromSeconds(10) - 1e-9));
  EXPECT_FALSE(Trajectory().At({0}));
  EXPECT_NEAR(kDrive.Length(), 3, 1e-12);
}

TEST(Trajectory, TransformedMovesPosesVelocitiesAndCovariances) {
  const Rigid3 site_from_odom{
      Eigen::Quaterniond(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ())), {5, 6, 7}};
  const Trajectory moved = kDrive.Transformed(site_from_odom);

  const TrajectoryState& last = moved.states().back();
  EXPECT_LT((last.world_from_body.translation - Eigen::Vector3d(5, 9, 7)).norm(), 1e-12);
  EXPECT_LT((last.velocity_in_world - Eigen::Vector3d(0, 1, 0)).norm(), 1e-12);
  EXPECT_NEAR(last.covariance(0, 0), 1, 1e-12);  // rotation is in body: stays
  EXPECT_NEAR(last.covariance(3, 3), 5, 1e-12);  // x and y of the position change places
  EXPECT_NEAR(last.covariance(4, 4), 4, 1e-12);
  EXPECT_NEAR(moved.Length(), 3, 1e-12);
}

TEST(Trajectory, TimesMustIncreaseAndAllMustBeFinite) {
  EXPECT_THROW(Trajectory({StateAt(1, 0, 0), StateAt(1, 1, 0)}), Error);
  EXPECT_THROW(Trajectory({StateAt(1, NAN, 0)}), Error);
}

class TumFile : public testing::Test {
 protected:
  ~TumFile() override { std::filesystem::remove(file_); }
  const std::filesystem::path file_ =
      std::filesystem::path(testing::TempDir()) / ("poses_" + std::to_string(::getpid()) + ".tum");
};

TEST_F(TumFile, IsReadBackToNineDigits) {
  const std::vector<TimedPose> poses = {
      {{1403715285262142976},
       {Eigen::Quaterniond(0.9, 0.1, -0.2, 0.3).normalized(), {1.0 / 3, -2e5, 1e-7}}},
      {{1403715285312142976}, {}}};

  WriteTum(poses, file_);
  const std::vector<TimedPose> again = ReadTum(file_);

  ASSERT_EQ(again.size(), 2U);
  EXPECT_EQ(again[0].time, poses[0].time);
  EXPECT_LT((again[0].world_from_frame.Matrix() - poses[0].world_from_frame.Matrix()).norm(), 1e-8);
  EXPECT_EQ(again[1].time, poses[1].time);
}

TEST_F(TumFile, ForeignFilesAreReadAndBrokenLinesAreNamed) {
  std::ofstream(file_)
      << "# time x y z qx qy qz qw\r\n\n1.5 1 2 3 0 0 0 1\r\n1.5e+09 1 2 3 0 0 0 0.9999\n";
  EXPECT_EQ(ReadTum(file_).size(), 2U);

  for (const char* line : {"1 2 3", "1 2 3 4 0 0 0 0", "x 1 2 3 0 0 0 1", "1 nan 2 3 0 0 0 1",
                           "1 2 3x 4 0 0 0 1", "1 2 3 4 nan 0 0 1", "1 +-2 3 4 0 0 0 1"}) {
    std::ofstream(file_) << "1.5 1 2 3 0 0 0 1\n" << line << "\n";
    EXPECT_THROW(ReadTum(file_), Error) << line;
  }
}

}  // namespace
}  // namespace parkade
