#include "tests/simulator/tracks/track_simulator.h"

#include <gtest/gtest.h>

#include <map>

#include "tests/simulator/drives/plan_drive.h"
#include "tests/simulator/scenes/build_scene.h"
#include "tests/simulator/tracks/track_crossing.h"
#include "tests/simulator/tracks/track_drive.h"
#include "tests/simulator/vehicle/simulated_rig.h"

namespace parkade::simulator {
namespace {

constexpr std::uint64_t kSeed = 3;
constexpr double kDuration = 20, kRate = 20;  // [s], [Hz]

/// Follows without any error.
TrackModel Perfect() {
  TrackModel model;
  model.white = model.blur = model.drift = model.slide = model.slide_beside = model.jump = 0;
  model.edges = model.shadow = 0;
  model.crossing_noise = 0;
  return model;
}

/// A short drive and its world; cheap to make, as nothing is painted finely.
struct Stage {
  Scene scene = BuildScene("lot", {.seed = kSeed, .ground_texel = 0.2});
  DrivePlan plan = PlanDrive(scene.place, DriverOptions{}, kDuration, kSeed);
  TrackWorld world{scene};
  Rig rig = MakeSimulatedRig({.line_delay = 3e-5}, kSeed);
  Timestamp epoch = DriveEpoch(kSeed);

  Stage() {
    for (RigCamera& camera : rig.cameras) camera.mask = world.OwnCarMask(camera, kHalfFieldOfView);
  }
  TrackEye EyeOf(size_t camera) const { return {plan.motion, epoch, rig.cameras[camera]}; }
};

Stage& TheStage() {
  static Stage stage;
  return stage;
}

TEST(TrackEye, SeesThroughARollingShutterWhatItProjects) {
  const Stage& stage = TheStage();
  const TrackEye eye = stage.EyeOf(0);
  for (double seconds = 4; seconds < 12; seconds += 0.7) {
    const Timestamp time = stage.epoch + seconds;
    const Eigen::Vector3d point =
        eye.WorldFromCamera(time) * Eigen::Vector3d(1.5 * std::sin(seconds), 0.5, 4);

    const auto pixel = eye.Project(point, time);
    ASSERT_TRUE(pixel);
    const auto line = eye.LineOf(*pixel, time);

    ASSERT_TRUE(line);
    EXPECT_LT(line->direction.cross(point - line->origin).norm(), 1e-7);
    // Not the same as with a global shutter while the car moves.
    if (stage.plan.motion.At(seconds).velocity_in_world.norm() < 2) continue;
    const auto at_once = eye.camera().model.Project(eye.WorldFromCamera(time).Inverse() * point);
    EXPECT_GT((*pixel - *at_once).norm(), 1e-3);
  }
}

TEST(TrackWorld, SeesTheGroundBelowAndNothingThroughIt) {
  Stage& stage = TheStage();
  const Rigid3 body = stage.plan.motion.WorldFromBody(5);
  const Eigen::Vector3d above = body * Eigen::Vector3d(6, 0, 1.5);

  const auto sight = stage.world.Look(above, -Eigen::Vector3d::UnitZ());

  ASSERT_TRUE(sight);
  EXPECT_TRUE(sight->is_ground);
  EXPECT_NEAR(sight->distance, 1.5, 0.3);
  EXPECT_GT(sight->normal.z(), 0.9);
  EXPECT_FALSE(stage.world.IsHidden(above, sight->point));
  EXPECT_TRUE(stage.world.IsHidden(above, sight->point - Eigen::Vector3d(0, 0, 0.5)));
}

TEST(TrackSimulator, WithoutErrorsTracksReprojectExactlyAndStayVisible) {
  Stage& stage = TheStage();
  const TrackEye eye = stage.EyeOf(1);
  TrackSimulator simulator(eye, stage.rig.cameras[1], 1, stage.world, Perfect(), kSeed);
  std::map<std::int64_t, Eigen::Vector3d> anchors;
  int followed = 0;
  for (int i = 0; i < 40; ++i) {
    const Timestamp time = stage.epoch + (6 + i / kRate);
    const TrackedFrame frame = simulator.Track(time, time);

    ASSERT_EQ(frame.observations.size(), simulator.tracks().size());
    for (size_t k = 0; k < frame.observations.size(); ++k) {
      const LiveTrack& track = simulator.tracks()[k];
      const FeatureObservation& seen = frame.observations[k];
      ASSERT_EQ(seen.track, track.number);
      EXPECT_LT((seen.pixel - *eye.Project(track.anchor, time)).norm(), 1e-9);
      EXPECT_LT(seen.bearing.cross(*eye.camera().model.Unproject(seen.pixel)).norm(), 1e-12);
      EXPECT_EQ(stage.rig.cameras[1].mask.at<std::uint8_t>(static_cast<int>(seen.pixel.y()),
                                                           static_cast<int>(seen.pixel.x())),
                255);
      EXPECT_FALSE(stage.world.IsHidden(eye.WorldFromCamera(time, seen.pixel.y()).translation,
                                        track.anchor));
      const auto [known, is_new] = anchors.emplace(seen.track, track.anchor);
      EXPECT_EQ(known->second, track.anchor);
      followed += !is_new;
    }
  }
  EXPECT_GT(followed, 40 * 100);
}

TEST(TrackSimulator, SameSeedSameTracksOtherSeedOthers) {
  Stage& stage = TheStage();
  const TrackEye eye = stage.EyeOf(0);
  const auto track = [&](std::uint64_t seed) {
    TrackSimulator simulator(eye, stage.rig.cameras[0], 0, stage.world, TrackModel{}, seed);
    TrackedFrame last;
    for (int i = 0; i < 10; ++i) {
      const Timestamp time = stage.epoch + (6 + i / kRate);
      last = simulator.Track(time, time);
    }
    return last;
  };
  const TrackedFrame once = track(1), again = track(1), other = track(2);

  ASSERT_EQ(once.observations.size(), again.observations.size());
  bool differs = once.observations.size() != other.observations.size();
  for (size_t i = 0; i < once.observations.size(); ++i) {
    EXPECT_EQ(once.observations[i].track, again.observations[i].track);
    EXPECT_EQ(once.observations[i].pixel, again.observations[i].pixel);
    differs = differs || once.observations[i].pixel != other.observations[i].pixel;
  }
  EXPECT_TRUE(differs);
}

// What a rear camera leaves behind converges on its vanishing point.
TEST(TrackSimulator, TracksThatMeetAreThinned) {
  Stage& stage = TheStage();
  const TrackEye eye = stage.EyeOf(3);
  TrackSimulator simulator(eye, stage.rig.cameras[3], 3, stage.world, TrackModel{}, kSeed);
  for (int i = 0; i < 120; ++i) {
    const Timestamp time = stage.epoch + (6 + i / kRate);
    const TrackedFrame frame = simulator.Track(time, time);
    ASSERT_GT(frame.observations.size(), 1u);
    for (size_t a = 0; a < frame.observations.size(); ++a)
      for (size_t b = 0; b < a; ++b)
        ASSERT_GT((frame.observations[a].pixel - frame.observations[b].pixel).norm(), 6) << "[px]";
  }
}

TEST(TrackSimulator, ForgetsItsTracksInALongPause) {
  Stage& stage = TheStage();
  const TrackEye eye = stage.EyeOf(0);
  TrackSimulator simulator(eye, stage.rig.cameras[0], 0, stage.world, TrackModel{}, kSeed);
  const TrackedFrame before = simulator.Track(stage.epoch + 6.0, stage.epoch + 6.0);

  const TrackedFrame after = simulator.Track(stage.epoch + 8.0, stage.epoch + 8.0);

  EXPECT_GT(after.observations.front().track, before.observations.back().track);
}

/// Matches of all pairs at one moment, when the odometry believes in `nominal`.
size_t CountCrossings(const Rig& nominal) {
  Stage& stage = TheStage();
  TrackCrossing crossing(stage.world, Perfect(), CrossCameraOptions{}, kSeed);
  size_t matched = 0;
  for (const CameraPair& pair : OverlappingPairs(stage.rig)) {
    const TrackEye from_eye = stage.EyeOf(pair.from), to_eye = stage.EyeOf(pair.to);
    TrackSimulator from(from_eye, nominal.cameras[pair.from], static_cast<int>(pair.from),
                        stage.world, Perfect(), kSeed);
    TrackSimulator to(to_eye, nominal.cameras[pair.to], static_cast<int>(pair.to), stage.world,
                      Perfect(), kSeed);
    const Timestamp time = stage.epoch + 7.0, later = time + 0.008;
    from.Track(time, time);
    std::map<std::int64_t, Eigen::Vector3d> anchors;
    for (const LiveTrack& track : from.tracks()) anchors[track.number] = track.anchor;
    for (const FeatureObservation& match : crossing.Match(from, {time, from.tracks()}, to, later)) {
      EXPECT_LT((match.pixel - *to_eye.Project(anchors.at(match.track), later)).norm(), 1e-4);
      ++matched;
    }
  }
  return matched;
}

TEST(TrackCrossing, FindsTracksWhereTwoCamerasSeeThemAndTheRigIsRight) {
  const Rig& rig = TheStage().rig;
  Rig off = rig;
  for (size_t camera = 0; camera < rig.cameras.size(); ++camera)
    off.cameras[camera].body_from_camera.rotation = off.cameras[camera].body_from_camera.rotation *
                                                    ExpSo3({0.06, camera % 2 ? 0.06 : -0.06, 0});

  const size_t right = CountCrossings(rig), wrong = CountCrossings(off);

  EXPECT_GT(right, 10u);
  EXPECT_LT(wrong, right / 2);
}

TEST(TrackDrive, HasGapsAndStampsAsTheFaultsSay) {
  TrackDriveOptions options;
  options.drive.seed = 3;
  options.drive.duration = 12;
  options.drive.faults.darkness = {6, 8};
  options.drive.faults.image_gap = {2, 4, 5};
  options.drive.faults.imu_gap = {9, 9.4};
  options.drive.faults.time_offsets = {0.02};
  options.drive.faults.extrinsic_rotation_deg = {1};

  const TrackDrive drive = MakeTrackDrive(options);

  ASSERT_FALSE(drive.images.empty());
  ASSERT_FALSE(drive.imu.empty());
  const Timestamp epoch = DriveEpoch(3);
  for (const SeenImage& image : drive.images) {
    const double time = image.frame.time - epoch + 0.02;  // t_imu = stamp + offset
    EXPECT_EQ(image.frame.observations.empty(), 6 <= time && time < 8) << time;
    EXPECT_FALSE(image.frame.camera == 2 && 4 < time && time < 5);
  }
  for (const ImuSample& sample : drive.imu)
    EXPECT_FALSE(9 <= sample.time - epoch && sample.time - epoch < 9.4);
  for (size_t camera = 0; camera < 4; ++camera) {
    const Rigid3 off = drive.true_rig.cameras[camera].body_from_camera.Inverse() *
                       drive.rig.cameras[camera].body_from_camera;
    EXPECT_NEAR(LogSo3(off.rotation).norm() * 180 / M_PI, 1, 1e-6);
    EXPECT_EQ(drive.rig.cameras[camera].time_shift, 0);
    EXPECT_EQ(drive.true_rig.cameras[camera].time_shift, 0.02);
  }
}

}  // namespace
}  // namespace parkade::simulator
