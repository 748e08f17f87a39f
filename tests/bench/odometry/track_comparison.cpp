// How alike tracks of rendered images and tracks of track mode are: prints the
// statistics of both, camera by camera, and on request what the odometry makes of both.
#include <CLI/CLI.hpp>
#include <iostream>

#include "core/options_json.h"
#include "slam/evaluation/evaluate_trajectory.h"
#include "tests/bench/odometry/odometry_statistics.h"
#include "tests/simulator/drives/plan_drive.h"
#include "tests/simulator/scenes/build_scene.h"
#include "tests/simulator/tracks/track_crossing.h"
#include "tests/simulator/tracks/track_rendered.h"
#include "tests/simulator/tracks/track_statistics.h"
#include "tests/simulator/vehicle/simulated_rig.h"

namespace parkade::simulator {
namespace {

struct CommandLine {
  TrackDriveOptions options;
  Stretch stretch{.begin = 8, .end = 10, .cameras = {}};
  std::vector<std::string> assignments;
  bool is_quick = false, wants_estimate = false;
};

/// The images of a stretch.
std::vector<SeenImage> Within(const std::vector<SeenImage>& images, const Stretch& stretch,
                              Timestamp epoch) {
  std::vector<SeenImage> result;
  for (const SeenImage& image : images)
    if (image.frame.time - epoch >= stretch.begin && image.frame.time - epoch <= stretch.end)
      result.push_back(image);
  return result;
}

void PrintTracks(const std::string& title, const std::vector<SeenImage>& images, const Rig& rig,
                 const Motion& motion, Timestamp epoch, TrackWorld& world) {
  for (size_t camera = 0; camera < rig.cameras.size(); ++camera) {
    const TrackEye eye(motion, epoch, rig.cameras[camera]);
    std::vector<TrackedFrame> frames;
    size_t num_crossed = 0;
    for (const SeenImage& image : images) {
      if (image.frame.camera != static_cast<int>(camera)) continue;
      frames.push_back(image.frame);
      num_crossed += image.crossed.size();
    }
    std::cout << rig.cameras[camera].name << " " << title << ": "
              << ToText(MeasureTracks(frames, eye, world)) << "crossed per frame "
              << static_cast<double>(num_crossed) /
                     static_cast<double>(std::max<size_t>(1, frames.size()))
              << "\n";
  }
}

void PrintEstimate(const std::string& title, const TrackDrive& drive) {
  const OdometryResult result = EstimateTrackDrive(drive, {});
  const TrajectoryEvaluation error =
      EvaluateTrajectory(drive.truth, ToTimedPoses(result.odom_from_body));
  std::cout << title << ": " << drive.length << " m, drift " << error.drift_percent << " %, NEES";
  for (const PoseConsistency& at : MeasureConsistency(
           result.odom_from_body, drive.truth, drive.rig.body_from_imu, {0.25, 0.5, 0.75, 1}))
    std::cout << " " << at.pose << " (" << at.rotation << ", " << at.position << ")";
  std::cout << "; noise scales";
  for (const CameraHealth& camera : result.report.cameras) std::cout << " " << camera.noise_scale;
  std::cout << "\n";
}

std::vector<SeenImage> Render(const CommandLine& line, const Scene& scene, const Rig& rig,
                              const Motion& motion) {
  const RenderedTracks rendered = TrackRenderedDrive(
      scene, rig, motion, line.stretch, static_cast<std::uint64_t>(line.options.drive.seed));
  std::cout << "rendering " << rendered.render_seconds << " s, tracking " << rendered.track_seconds
            << " s per image\n";
  std::vector<SeenImage> images;
  for (size_t i = 0; i < rendered.frames.size(); ++i)
    images.push_back({.frame = rendered.frames[i],
                      .crossed = rendered.crossed[i],
                      .pair_seconds = kMaxPairTime});
  return images;
}

int Run(CommandLine& line) {
  for (const std::string& assignment : line.assignments) SetOption(assignment, line.options);
  SimulateOptions& options = line.options.drive;
  options.sensors.has_wheels = false;
  line.stretch.cameras = options.cameras;
  if (line.wants_estimate) line.stretch.begin = 0, line.stretch.end = options.duration;
  line.options.begin = line.stretch.begin;  // both see everything for the first time there
  const auto seed = static_cast<std::uint64_t>(options.seed);
  const Timestamp epoch = DriveEpoch(seed);
  if (line.is_quick) options.ground_texel = 0.2;
  const Scene scene = BuildScene(options.scene, options.OfScene());
  TrackWorld world(scene);
  const Motion motion = PlanDrive(scene.place, options.drive, options.duration, seed).motion;
  TrackDrive drive = MakeTrackDrive(line.options);
  std::cout << 1e3 * drive.seconds_per_image << " ms per image of track mode\n";
  PrintTracks("tracks", Within(drive.images, line.stretch, epoch), drive.true_rig, motion, epoch,
              world);
  if (line.wants_estimate) PrintEstimate("track mode", drive);
  if (line.is_quick) return 0;
  drive.images = Render(line, scene, drive.true_rig, motion);
  PrintTracks("rendered", drive.images, drive.true_rig, motion, epoch, world);
  if (line.wants_estimate) PrintEstimate("rendered", drive);
  return 0;
}

}  // namespace
}  // namespace parkade::simulator

int main(int argc, char** argv) {
  using namespace parkade::simulator;
  CLI::App app{"Compares track mode with the real tracker on rendered images.",
               "parkade-track-comparison"};
  CommandLine line;
  app.add_option("--scene", line.options.drive.scene, "As parkade-simulate --list")
      ->capture_default_str();
  app.add_option("--seed", line.options.drive.seed, "Of everything")->capture_default_str();
  app.add_option("--duration", line.options.drive.duration, "[s] of the drive")
      ->capture_default_str();
  app.add_option("--begin", line.stretch.begin, "[s] images are rendered from here")
      ->capture_default_str();
  app.add_option("--end", line.stretch.end, "[s] to here")->capture_default_str();
  app.add_flag("--no-render", line.is_quick, "Track mode alone");
  app.add_flag("--estimate", line.wants_estimate,
               "Render all of the drive, and run the odometry on both");
  app.add_option("--set", line.assignments, "drive.cameras.rate=10, model.slide=0 and the like");
  CLI11_PARSE(app, argc, argv);
  try {
    return Run(line);
  } catch (const std::exception& error) {
    std::cerr << "parkade-track-comparison: " << error.what() << "\n";
    return 2;
  }
}
