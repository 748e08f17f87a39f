#include "export/pose_files.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <sstream>

namespace parkade {
namespace {

std::vector<TimedPose> MakePoses() {
  std::vector<TimedPose> poses;
  for (int i = 0; i < 5; ++i)
    poses.push_back(
        {{1'403'715'273'262'142'976 + i * 50'000'000LL},
         {Eigen::Quaterniond(Eigen::AngleAxisd(0.3 * i, Eigen::Vector3d(1, 2, 3).normalized())),
          {100.5 + i, -2.25 * i, 0.125}}});
  return poses;
}

TEST(PoseFiles, KittisRowsAreTheMatrix) {
  const std::vector<TimedPose> poses = MakePoses();
  ASSERT_FALSE(poses.empty());
  std::istringstream text(EncodeKittiPoses(poses));
  for (const TimedPose& pose : poses) {
    std::string line;
    ASSERT_TRUE(std::getline(text, line));
    std::istringstream numbers(line);
    for (int i = 0; i < 12; ++i) {
      double value = 0;
      ASSERT_TRUE(numbers >> value);
      EXPECT_NEAR(value, pose.world_from_frame.Matrix()(i / 4, i % 4), 1e-7);
    }
    EXPECT_FALSE(numbers >> line);
  }
}

TEST(PoseFiles, EurocsLinesHaveNanosecondsAndTheRealPartFirst) {
  const std::vector<TimedPose> poses = MakePoses();
  std::istringstream text(EncodeEurocPoses(poses));
  std::string line;
  ASSERT_TRUE(std::getline(text, line));
  EXPECT_TRUE(line.starts_with("#timestamp [ns]"));
  for (const TimedPose& pose : poses) {
    ASSERT_TRUE(std::getline(text, line));
    long long ns = 0;
    double x = 0, y = 0, z = 0, qw = 0, qx = 0, qy = 0, qz = 0;
    ASSERT_EQ(std::sscanf(line.c_str(), "%lld,%lf,%lf,%lf,%lf,%lf,%lf,%lf", &ns, &x, &y, &z, &qw,
                          &qx, &qy, &qz),
              8);
    EXPECT_EQ(ns, pose.time.ns);
    EXPECT_TRUE(Eigen::Vector3d(x, y, z).isApprox(pose.world_from_frame.translation, 1e-9));
    EXPECT_LT(Eigen::Quaterniond(qw, qx, qy, qz).angularDistance(pose.world_from_frame.rotation),
              1e-7);
  }
}

}  // namespace
}  // namespace parkade
