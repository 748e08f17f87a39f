// Track mode against the real tracker on rendered images of the same drive.
#include "tests/simulator/tracks/track_statistics.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/simulator/drives/plan_drive.h"
#include "tests/simulator/scenes/build_scene.h"
#include "tests/simulator/tracks/track_rendered.h"
#include "tests/simulator/tracks/track_simulator.h"
#include "tests/simulator/vehicle/simulated_rig.h"

namespace parkade::simulator {
namespace {

const TrackErrorAtAge& At(const TrackStatistics& statistics, int age) {
  const auto found = std::find_if(statistics.ages.begin(), statistics.ages.end(),
                                  [&](const TrackErrorAtAge& entry) { return entry.age == age; });
  EXPECT_NE(found, statistics.ages.end()) << "no track lived for " << age << " frames";
  return found == statistics.ages.end() ? statistics.ages.front() : *found;
}

void ExpectWithinFactor(double value, double reference, double factor, const std::string& name) {
  EXPECT_LT(value, reference * factor) << name;
  EXPECT_GT(value, reference / factor) << name;
}

/// Front and left camera for a second in mid-drive: images are dear.
TEST(TrackMode, LivesAndErrorsAreLikeThoseOfRenderedImages) {
  constexpr std::uint64_t kSeed = 1;
  const Scene scene = BuildScene("lot", {.seed = kSeed, .ground_texel = 0.015});
  TrackWorld world(scene);
  Rig rig = MakeSimulatedRig({.num_cameras = 2}, kSeed);
  for (RigCamera& camera : rig.cameras) camera.mask = world.OwnCarMask(camera, kHalfFieldOfView);
  const DrivePlan plan = PlanDrive(scene.place, DriverOptions{}, 40, kSeed);
  Stretch stretch{.begin = 9, .end = 10.2, .cameras = {}};
  stretch.cameras.rate = 20;
  const RenderedTracks rendered = TrackRenderedDrive(scene, rig, plan.motion, stretch, kSeed);
  for (size_t camera = 0; camera < rig.cameras.size(); ++camera) {
    SCOPED_TRACE(rig.cameras[camera].name);
    const TrackEye eye(plan.motion, DriveEpoch(kSeed), rig.cameras[camera]);
    TrackSimulator simulator(eye, rig.cameras[camera], static_cast<int>(camera), world,
                             TrackModel{}, kSeed);
    std::vector<TrackedFrame> real_frames, made_frames;
    for (const TrackedFrame& frame : rendered.frames) {
      if (frame.camera != static_cast<int>(camera)) continue;
      real_frames.push_back(frame);
      made_frames.push_back(simulator.Track(frame.time, frame.time));
    }

    const TrackStatistics real = MeasureTracks(real_frames, eye, world),
                          made = MeasureTracks(made_frames, eye, world);

    EXPECT_NEAR(made.tracks_per_frame, real.tracks_per_frame, 0.1 * real.tracks_per_frame);
    EXPECT_NEAR(made.on_ground, real.on_ground, 0.2);
    ExpectWithinFactor(made.new_per_frame, real.new_per_frame, 2, "new tracks");
    ExpectWithinFactor(made.step, real.step, 2, "step");
    ExpectWithinFactor(made.middle, real.middle, 1.7, "distance");
    for (const int age : {1, 5, 12}) {
      SCOPED_TRACE(age);
      EXPECT_NEAR(At(made, age).survival, At(real, age).survival, 0.25);
      EXPECT_NEAR(At(made, age).gross, At(real, age).gross, 0.15);
      ExpectWithinFactor(At(made, age).along, At(real, age).along, 2.5, "error along the flow");
      ExpectWithinFactor(At(made, age).across, At(real, age).across, 2.5, "error across the flow");
    }
  }
}

}  // namespace
}  // namespace parkade::simulator
