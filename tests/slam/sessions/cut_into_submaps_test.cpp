#include "slam/sessions/cut_into_submaps.h"

#include <gtest/gtest.h>

#include "core/error.h"

namespace parkade {
namespace {

// 1 m/s along x for `seconds`, a keyframe each metre, a landmark beside each, on a body that pitches by 0.1 rad.
OdometryResult StraightDrive(int seconds) {
  OdometryResult odometry;
  std::vector<TrajectoryState> states;
  for (int k = 0; k <= seconds; ++k) {
    TrajectoryState state;
    state.time = TimestampFromSeconds(k);
    state.odom_from_body = {ExpSo3({0, 0.1, 0}), {static_cast<double>(k), 0, 0}};
    states.push_back(state);
    odometry.keyframes.push_back({state.time, k % 4, state.odom_from_body});
    odometry.landmarks.push_back({state.time, 0, Eigen::Vector3d(k, 3, 1), k % 10 == 0 ? 5.0 : 0.1, 7});
  }
  odometry.odom_from_body = Trajectory(states);
  return odometry;
}

TEST(CutIntoSubmaps, CutsByLengthAndJoinsAShortRemainder) {
  EXPECT_EQ(CutIntoSubmaps(StraightDrive(100), 0).size(), 2u);
  EXPECT_EQ(CutIntoSubmaps(StraightDrive(120), 0).size(), 2u);
  EXPECT_EQ(CutIntoSubmaps(StraightDrive(130), 0).size(), 3u);
  EXPECT_EQ(CutIntoSubmaps(StraightDrive(3), 0).size(), 1u);
}

TEST(CutIntoSubmaps, EveryKeyframeIsInOneSubmapAndKeepsItsPose) {
  const OdometryResult odometry = StraightDrive(130);

  const std::vector<Submap> submaps = CutIntoSubmaps(odometry, 7);

  size_t next = 0;
  for (const Submap& submap : submaps) {
    EXPECT_EQ(submap.drive, 7);
    for (const Keyframe& keyframe : submap.keyframes) {
      ASSERT_LT(next, odometry.keyframes.size());
      const Rigid3 odom_from_body = submap.odom_from_submap * keyframe.submap_from_body;
      EXPECT_EQ(keyframe.time, odometry.keyframes[next].time);
      EXPECT_LT((odom_from_body.translation - odometry.keyframes[next].odom_from_body.translation).norm(), 1e-9);
      ++next;
    }
  }
  EXPECT_EQ(next, odometry.keyframes.size());
}

TEST(CutIntoSubmaps, SubmapsAreLevelAndBeginAtTheirFirstKeyframe) {
  for (const Submap& submap : CutIntoSubmaps(StraightDrive(130), 0)) {
    EXPECT_LT((submap.odom_from_submap.rotation * Eigen::Vector3d::UnitZ() - Eigen::Vector3d::UnitZ()).norm(), 1e-12);
    EXPECT_LT(submap.keyframes.front().submap_from_body.translation.norm(), 1e-9);
  }
}

TEST(CutIntoSubmaps, CertainLandmarksGoWhereTheyWereFirstSeen) {
  const std::vector<Submap> submaps = CutIntoSubmaps(StraightDrive(130), 0);

  size_t count = 0;
  for (const Submap& submap : submaps) {
    for (const Landmark& landmark : submap.landmarks) {
      EXPECT_GE(landmark.point_in_submap.x(), -1e-9);
      EXPECT_LT(landmark.point_in_submap.x(), 51);
      EXPECT_NEAR(landmark.point_in_submap.y(), 3, 1e-9);
    }
    count += submap.landmarks.size();
  }
  EXPECT_EQ(count, 131u - 14u);  // every tenth is too uncertain
}

TEST(CutIntoSubmaps, NothingGivesNothingAndBadOptionsAreRefused) {
  EXPECT_TRUE(CutIntoSubmaps(OdometryResult{}, 0).empty());
  SubmapOptions options;
  options.length = 0;
  EXPECT_THROW(CutIntoSubmaps(OdometryResult{}, 0, options), Error);
}

}  // namespace
}  // namespace parkade
