#include "slam/tracking/cross_camera_matcher.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <map>
#include <opencv2/core.hpp>

#include "core/error.h"
#include "slam/tracking/feature_tracker.h"
#include "tests/slam/worlds/real_clip.h"
#include "tests/slam/worlds/rendered_room.h"

namespace parkade {
namespace {

/// Looks along body x.
const Rigid3 kForward{Eigen::Quaterniond(0.5, -0.5, 0.5, -0.5), {0, 0, 0}};

RigCamera MakeCamera(const CameraModel& model, const Rigid3& body_from_camera) {
  RigCamera camera;
  camera.model = model;
  camera.body_from_camera = body_from_camera;
  return camera;
}

Rigid3 Between(const RigCamera& from, const RigCamera& to) {
  return to.body_from_camera.Inverse() * from.body_from_camera;
}

/// What the matcher found, beside where the points really are.
struct Result {
  size_t num_tracks = 0, num_matches = 0, num_wrong = 0;  ///< wrong: off by more than 1.5 px
  double median_error = 0;                                ///< [px]
};

Result MatchInRoom(const RigCamera& first, const RigCamera& second,
                   const Rigid3& error_of_extrinsics = {}) {
  const RenderedRoom room({-8, -6, 0}, {8, 6, 3}, 11);
  const Rigid3 room_from_body{ExpSo3({0, 0, 0.4}), {-2, 1, 0.9}};
  TrackedImage images[2];
  Rigid3 poses[2];
  std::optional<RoomCamera> drawn;
  int index = 0;
  for (const RigCamera* camera : {&first, &second}) {
    const RoomCamera room_camera(camera->model, room);
    poses[index] = room_from_body * camera->body_from_camera;
    FeatureTracker tracker(*camera, index);
    tracker.Track({Timestamp{1000}, index, room_camera.Render(poses[index], 1.0, index)},
                  Eigen::Matrix3d::Identity());
    images[index++] = tracker.last_image();
    drawn.emplace(room_camera);
  }

  const std::vector<FeatureObservation> matches =
      MatchAcross(images[0], images[1], error_of_extrinsics * Between(first, second));

  std::map<std::int64_t, Eigen::Vector3d> points;
  for (const FeatureObservation& track : images[0].observations) {
    const Eigen::Vector3d direction = poses[0].rotation * track.bearing;
    points[track.track] =
        poses[0].translation + room.RangeAlong(poses[0].translation, direction) * direction;
  }
  Result result{points.size(), matches.size()};
  std::vector<double> errors;
  for (const FeatureObservation& match : matches) {
    const auto expected = second.model.Project(poses[1].Inverse() * points.at(match.track));
    errors.push_back(expected ? (match.pixel - *expected).norm() : 1e3);
    result.num_wrong += errors.back() > 1.5;
    EXPECT_NEAR(match.sigma, 0.5 / *second.model.PixelsPerRadian(match.pixel), 1e-12);
    EXPECT_LT((*second.model.Project(match.bearing) - match.pixel).norm(), 1e-6);
  }
  std::sort(errors.begin(), errors.end());
  if (!errors.empty()) result.median_error = errors[errors.size() / 2];
  return result;
}

TEST(MatchAcross, AStereoPairFindsNearlyAllItsPoints) {
  const CameraModel lens(PinholeProjection{.fx = 400, .fy = 400, .cx = 319.5, .cy = 199.5}, 640,
                         400);
  const RigCamera left = MakeCamera(lens, kForward),
                  right = MakeCamera(lens, Rigid3{{1, 0, 0, 0}, {0, -0.4, 0}} * kForward);

  const Result result = MatchInRoom(left, right);

  EXPECT_GT(result.num_matches, result.num_tracks * 7 / 10);
  EXPECT_LE(result.num_wrong, result.num_matches / 50);
  EXPECT_LT(result.median_error, 0.15);
}

TEST(MatchAcross, FisheyesAtRightAnglesMeetAtTheCorner) {
  const RigCamera front =
      MakeCamera(SurroundFisheye(), Rigid3{{1, 0, 0, 0}, {3.7, 0, -0.2}} * kForward);
  const RigCamera left =
      MakeCamera(SurroundFisheye(), Rigid3{ExpSo3({0, 0, M_PI / 2}), {2.0, 1.0, 0.1}} * kForward);

  const Result result = MatchInRoom(front, left);

  EXPECT_GT(result.num_matches, 15u) << "of " << result.num_tracks;
  EXPECT_LE(result.num_wrong, result.num_matches / 10);
  EXPECT_LT(result.median_error, 0.4);
}

TEST(MatchAcross, SlightlyWrongExtrinsicsAreTolerated) {
  const CameraModel lens(PinholeProjection{.fx = 400, .fy = 400, .cx = 319.5, .cy = 199.5}, 640,
                         400);
  const RigCamera left = MakeCamera(lens, kForward),
                  right = MakeCamera(lens, Rigid3{{1, 0, 0, 0}, {0, -0.4, 0}} * kForward);

  const Result result =
      MatchInRoom(left, right, {ExpSo3({0.002, 0.002, 0.002}), {0.005, 0.005, 0.005}});

  EXPECT_GT(result.num_matches, result.num_tracks / 2);
  EXPECT_LE(result.num_wrong, result.num_matches / 50);
}

TEST(MatchAcross, CamerasThatSeeNothingInCommonMatchNothing) {
  const CameraModel lens(PinholeProjection{.fx = 400, .fy = 400, .cx = 319.5, .cy = 199.5}, 640,
                         400);
  const RigCamera ahead = MakeCamera(lens, kForward);
  const RigCamera behind = MakeCamera(lens, Rigid3{ExpSo3({0, 0, M_PI}), {-1, 0, 0}} * kForward);

  EXPECT_EQ(MatchInRoom(ahead, behind).num_matches, 0u);
  EXPECT_EQ(ViewOverlap(ahead, behind), 0);
  EXPECT_TRUE(MatchAcross({}, {}, {}).empty());
}

TEST(ViewOverlap, GrowsWithTheFieldOfView) {
  const CameraModel narrow(PinholeProjection{.fx = 400, .fy = 400, .cx = 319.5, .cy = 199.5}, 640,
                           400);
  const Rigid3 beside{{1, 0, 0, 0}, {0, -0.5, 0}}, left{ExpSo3({0, 0, M_PI / 2}), {2, 1, 0}};

  EXPECT_GT(ViewOverlap(MakeCamera(narrow, kForward), MakeCamera(narrow, beside * kForward)), 0.9);
  EXPECT_EQ(ViewOverlap(MakeCamera(narrow, kForward), MakeCamera(narrow, left * kForward)), 0);
  const double fisheye = ViewOverlap(MakeCamera(SurroundFisheye(), kForward),
                                     MakeCamera(SurroundFisheye(), left * kForward));
  EXPECT_GT(fisheye, 0.2);
  EXPECT_LT(fisheye, 0.7);
}

TEST(CrossCameraOptions, NonsenseIsRefused) {
  CrossCameraOptions options;
  options.min_similarity = 1.5;
  EXPECT_THROW(MatchAcross({}, {}, {}, options), Error);
}

}  // namespace
}  // namespace parkade
