// How alike tracks of rendered pictures and tracks of track mode are: prints the
// statistics of both, camera by camera.
#include <CLI/CLI.hpp>
#include <chrono>
#include <iostream>

#include "core/options_json.h"
#include "tests/simulator/plan_drive.h"
#include "tests/simulator/simulated_rig.h"
#include "tests/simulator/track_drive.h"
#include "tests/simulator/track_rendered.h"
#include "tests/simulator/track_simulator.h"
#include "tests/simulator/track_statistics.h"

namespace parkade::simulator {
namespace {

void Print(const std::string& title, const std::vector<TrackedFrame>& all, const Rig& rig, const Motion& motion,
           Timestamp epoch, TrackWorld& world) {
  for (size_t camera = 0; camera < rig.cameras.size(); ++camera) {
    const TrackEye eye(motion, epoch, rig.cameras[camera]);
    std::vector<TrackedFrame> frames;
    for (const TrackedFrame& frame : all)
      if (frame.camera == static_cast<int>(camera)) frames.push_back(frame);
    std::cout << rig.cameras[camera].name << " " << title << ": " << ToText(MeasureTracks(frames, eye, world));
  }
}

}  // namespace
}  // namespace parkade::simulator

int main(int argc, char** argv) {
  using namespace parkade;
  using namespace parkade::simulator;
  CLI::App app{"Compares track mode with the real tracker on rendered pictures.", "parkade-track-comparison"};
  std::string scene_name = "lot";
  int seed = 1;
  double duration = 40;
  Stretch stretch{.begin = 8, .end = 10, .cameras = {}};
  stretch.cameras.rate = 20;
  RigOptions rig_options;
  app.add_option("--scene", scene_name);
  app.add_option("--seed", seed);
  app.add_option("--duration", duration, "[s] of the drive");
  app.add_option("--begin", stretch.begin, "[s] rendered from here");
  app.add_option("--end", stretch.end, "[s] to here");
  app.add_option("--rate", stretch.cameras.rate, "[Hz]");
  app.add_option("--cameras", rig_options.num_cameras);
  bool is_quick = false;
  TrackModel model;
  std::vector<std::string> assignments;
  app.add_flag("--no-render", is_quick, "Track mode alone");
  app.add_option("--set", assignments, "Of the track model: option=value");
  CLI11_PARSE(app, argc, argv);
  for (const std::string& assignment : assignments) SetOption(assignment, model);
  const auto seed64 = static_cast<std::uint64_t>(seed);
  const Scene scene = BuildScene(scene_name, {.seed = seed64, .ground_texel = is_quick ? 0.2 : 0.01});
  TrackWorld world(scene);
  Rig rig = MakeSimulatedRig(rig_options, seed64);
  for (RigCamera& camera : rig.cameras) camera.mask = world.OwnCarMask(camera, kHalfFieldOfView);
  const DrivePlan plan = PlanDrive(scene.place, DriverOptions{}, duration, seed64);
  const Timestamp epoch = DriveEpoch(seed64);
  if (!is_quick) {
    const RenderedTracks rendered = TrackRenderedDrive(scene, rig, plan.motion, stretch, seed64);
    std::cout << "rendering " << rendered.render_seconds << " s, tracking " << rendered.track_seconds
              << " s per picture\n";
    Print("rendered", rendered.frames, rig, plan.motion, epoch, world);
    size_t crossed = 0;
    for (const auto& observations : rendered.crossed) crossed += observations.size();
    std::cout << crossed << " crossed\n";
  }
  std::vector<TrackEye> eyes;
  std::vector<TrackSimulator> simulators;
  eyes.reserve(rig.cameras.size());
  for (size_t camera = 0; camera < rig.cameras.size(); ++camera) {
    eyes.emplace_back(plan.motion, epoch, rig.cameras[camera]);
    simulators.emplace_back(eyes.back(), rig.cameras[camera], static_cast<int>(camera), world, model, seed64);
  }
  std::vector<TrackedFrame> frames;
  const auto begin = std::chrono::steady_clock::now();
  for (const ScheduledFrame& frame : ScheduleFrames(plan.motion, rig.cameras.size(), stretch.cameras, 0.1, seed64))
    if (frame.time - epoch >= stretch.begin && frame.time - epoch <= stretch.end)
      frames.push_back(simulators[frame.camera].Track(frame.time, frame.time));
  std::cout << 1e3 * std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() /
                   static_cast<double>(frames.size())
            << " ms per frame of track mode\n";
  Print("tracks", frames, rig, plan.motion, epoch, world);
  TrackDriveOptions whole;
  whole.drive.scene = scene_name;
  whole.drive.seed = seed;
  whole.drive.duration = duration;
  whole.drive.rig = rig_options;
  whole.drive.cameras = stretch.cameras;
  whole.model = model;
  size_t num_crossed = 0;
  for (const SeenPicture& picture : MakeTrackDrive(whole).pictures)
    if (picture.frame.time - epoch >= stretch.begin && picture.frame.time - epoch <= stretch.end)
      num_crossed += picture.crossed.size();
  std::cout << num_crossed << " crossed in track mode\n";
  return 0;
}
