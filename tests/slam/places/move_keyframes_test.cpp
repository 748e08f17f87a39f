#include "slam/places/move_keyframes.h"

#include <gtest/gtest.h>

#include "slam/odometry/calibrated_log.h"
#include "slam/places/describe_keyframes.h"
#include "tests/slam/worlds/room_log.h"

namespace parkade {
namespace {

const KeyframeOptions kOptions{.spacing = RoomLog::kStep - 1e-6};

/// Keyframes without features.
std::vector<RigKeyframe> ChosenAlong(const Trajectory& odom_from_body) {
  return ChooseKeyframes(odom_from_body, kOptions);
}

std::vector<RigKeyframe> DescribedBy(const RoomLog& log, const PlacedDrive& estimate) {
  std::vector<RigKeyframe> chosen = ChosenAlong(estimate.odom_from_body), keyframes;
  const std::vector<bool> all(chosen.size(), true);
  DescribeKeyframes(CalibratedLog(log, estimate.rig), estimate.odom_from_body, kOptions, all,
                    std::move(chosen),
                    [&](RigKeyframe&& keyframe) { keyframes.push_back(std::move(keyframe)); });
  return keyframes;
}

std::vector<RigKeyframe> Move(const std::vector<RigKeyframe>& described, const PlacedDrive& from,
                              const PlacedDrive& to) {
  std::vector<RigKeyframe> moved;
  KeyframeMover mover(from, to, ChosenAlong(to.odom_from_body), kOptions,
                      [&](RigKeyframe&& keyframe) { moved.push_back(std::move(keyframe)); });
  for (const RigKeyframe& keyframe : described) mover.Add(keyframe);
  return moved;
}

/// [m] of the points from the wall that the room's camera looks at, the median.
double MedianErrorOf(const std::vector<RigKeyframe>& keyframes) {
  constexpr double kWall = 4;  // [m] along y
  std::vector<double> errors;
  for (const RigKeyframe& keyframe : keyframes)
    for (const KeyframeFeature& feature : keyframe.features)
      if (feature.point && std::abs(feature.bearing.x()) < 0.5 &&
          std::abs(feature.bearing.z()) < 0.1)
        errors.push_back(std::abs((keyframe.odom_from_keyframe * *feature.point).y() - kWall));
  if (errors.empty()) return 1e9;
  const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
  std::nth_element(errors.begin(), middle, errors.end());
  return *middle;
}

/// Another estimate of the room's drive: the mount is turned and displaced, and the drive is 6 %
/// longer.
struct WrongEstimate {
  explicit WrongEstimate(const RoomLog& log) : rig(log.rig()) {
    RigCamera& camera = rig.cameras[0];
    camera.body_from_camera.rotation =
        camera.body_from_camera.rotation * ExpSo3({0.02, 0.03, 0.01});
    camera.body_from_camera.translation += Eigen::Vector3d(0.1, 0.05, -0.1);
    const Trajectory truth = log.Truth();
    std::vector<TrajectoryState> states = truth.states();
    for (TrajectoryState& state : states) state.world_from_body.translation *= 1.06;
    odom_from_body = Trajectory(std::move(states));
  }

  Trajectory odom_from_body;
  Rig rig;
};

TEST(MoveKeyframes, WhatWasDescribedByAWrongEstimateIsAsIfByTheRightOne) {
  const RoomLog log(30);
  const WrongEstimate wrong(log);
  const Trajectory truth = log.Truth();
  const PlacedDrive from{wrong.odom_from_body, wrong.rig}, to{truth, log.rig()};

  const std::vector<RigKeyframe> described = DescribedBy(log, from), direct = DescribedBy(log, to),
                                 moved = Move(described, from, to);

  ASSERT_EQ(moved.size(), direct.size());
  const RigCamera& camera = log.rig().cameras[0];
  size_t num_points = 0, num_direct_points = 0;
  for (size_t i = 0; i < moved.size(); ++i) {
    EXPECT_EQ(moved[i].time, direct[i].time);
    EXPECT_EQ(moved[i].image_times, direct[i].image_times);
    EXPECT_EQ(moved[i].odom_from_keyframe.translation, direct[i].odom_from_keyframe.translation);
    for (const KeyframeFeature& feature : moved[i].features) {
      const Eigen::Vector2d pixel = feature.image_point.cast<double>().cwiseProduct(
          Eigen::Vector2d(camera.model.width(), camera.model.height()));
      const auto expected = camera.model.Project(camera.body_from_camera.rotation.conjugate() *
                                                 feature.bearing);  // body is keyframe
      ASSERT_TRUE(expected);
      EXPECT_LT((*expected - pixel).norm(), 1) << "image points are of whole pixels of a view";
      EXPECT_LT((feature.origin - camera.body_from_camera.translation).norm(), 1e-9);
      num_points += feature.point.has_value();
    }
    for (const KeyframeFeature& feature : direct[i].features)
      num_direct_points += feature.point.has_value();
  }
  EXPECT_GT(num_points, num_direct_points * 9 / 10);
  EXPECT_LT(MedianErrorOf(moved), 1.1 * MedianErrorOf(direct) + 0.005);
  EXPECT_GT(MedianErrorOf(described), 2 * MedianErrorOf(moved));
}

TEST(MoveKeyframes, NothingChangesWhereTheEstimateStays) {
  const RoomLog log(20);
  const Trajectory truth = log.Truth();
  const PlacedDrive estimate{truth, log.rig()};
  const std::vector<RigKeyframe> described = DescribedBy(log, estimate);

  const std::vector<RigKeyframe> moved = Move(described, estimate, estimate);

  ASSERT_EQ(moved.size(), described.size());
  for (size_t i = 0; i < moved.size(); ++i) {
    ASSERT_EQ(moved[i].features.size(), described[i].features.size());
    EXPECT_EQ(moved[i].image_times, described[i].image_times);
    EXPECT_EQ(moved[i].floor.data, described[i].floor.data) << "the same floor";
    for (size_t k = 0; k < moved[i].features.size(); ++k) {
      const KeyframeFeature &now = moved[i].features[k], &before = described[i].features[k];
      EXPECT_LT((now.bearing - before.bearing).norm(), 1e-12);
      ASSERT_EQ(now.point.has_value(), before.point.has_value());
      if (now.point) {
        EXPECT_LT((*now.point - *before.point).norm(), 1e-8);
      }
    }
  }
}

}  // namespace
}  // namespace parkade
