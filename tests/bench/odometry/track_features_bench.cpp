// One core: what a camera's image costs in the front end.
#include <benchmark/benchmark.h>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "slam/tracking/cross_camera_matcher.h"
#include "slam/tracking/feature_tracker.h"
#include "slam/tracking/image_pyramid.h"
#include "tests/slam/worlds/rendered_room.h"

namespace parkade {
namespace {

constexpr int kNumFrames = 12;
const Rigid3 kForward{Eigen::Quaterniond(0.5, -0.5, 0.5, -0.5), {0, 0, 0}};

/// A car that drives at 2 m/s on a curve through a room, seen by one fisheye.
struct Drive {
  RigCamera camera;
  std::vector<cv::Mat> images;
  std::vector<Rigid3> poses;
};

Drive MakeDrive(double scale, const Rigid3& body_from_camera = kForward) {
  cv::setNumThreads(1);
  const RenderedRoom room({-6, -4, 0}, {6, 4, 3}, 3);
  Drive drive;
  drive.camera.model = SurroundFisheye().Scaled(scale);
  drive.camera.body_from_camera = body_from_camera;
  const RoomCamera renderer(drive.camera.model, room);
  for (int i = 0; i < kNumFrames; ++i) {
    const double seconds = 0.05 * i, angle = 0.3 * seconds;
    const Rigid3 room_from_body{ExpSo3({0, 0, angle}), {2 * seconds - 2, seconds * angle, 1}};
    drive.poses.push_back(room_from_body * body_from_camera);
    drive.images.push_back(renderer.Render(drive.poses.back(), 1.0, i));
  }
  return drive;
}

void Track(FeatureTracker& tracker, const Drive& drive, int step, size_t last, size_t now) {
  const Eigen::Quaterniond turn =
      drive.poses[now].rotation.conjugate() * drive.poses[last].rotation;
  tracker.Track({Timestamp{1 + 50'000'000LL * step}, 0, drive.images[now]},
                turn.toRotationMatrix());
}

/// Argument: image width [px].
void TrackOneFrame(benchmark::State& state) {
  const Drive drive = MakeDrive(static_cast<double>(state.range(0)) / 640);
  FeatureTracker tracker(drive.camera, 0);
  int step = 0;
  size_t last = 0;
  double observations = 0;
  for (auto _ : state) {
    // To and fro, so that every frame follows a neighbor.
    const int phase = step % (2 * kNumFrames - 2);
    const auto now = static_cast<size_t>(phase < kNumFrames ? phase : 2 * kNumFrames - 2 - phase);
    Track(tracker, drive, step++, last, now);
    last = now;
    observations += static_cast<double>(tracker.last_image().observations.size());
  }
  state.counters["tracks"] = observations / step;
}
BENCHMARK(TrackOneFrame)->Arg(640)->Arg(1280)->Unit(benchmark::kMillisecond);

void Normalize(benchmark::State& state) {
  const Drive drive = MakeDrive(static_cast<double>(state.range(0)) / 640);
  for (auto _ : state) benchmark::DoNotOptimize(NormalizeLocally(drive.images[0]));
}
BENCHMARK(Normalize)->Arg(640)->Arg(1280)->Unit(benchmark::kMillisecond);

void Pyramid(benchmark::State& state) {
  const Drive drive = MakeDrive(static_cast<double>(state.range(0)) / 640);
  for (auto _ : state) benchmark::DoNotOptimize(BuildPyramid(drive.images[0], 4));
}
BENCHMARK(Pyramid)->Arg(640)->Arg(1280)->Unit(benchmark::kMillisecond);

/// Front fisheye to left mirror fisheye.
void MatchFisheyes(benchmark::State& state) {
  const Rigid3 left = Rigid3{ExpSo3({0, 0, M_PI / 2}), {-1.7, 1, 0.2}} * kForward;
  const Drive front_drive = MakeDrive(1), left_drive = MakeDrive(1, left);
  FeatureTracker front_tracker(front_drive.camera, 0), left_tracker(left_drive.camera, 1);
  Track(front_tracker, front_drive, 0, 0, 0);
  Track(left_tracker, left_drive, 0, 0, 0);
  size_t matches = 0;
  for (auto _ : state)
    matches = MatchAcross(front_tracker.last_image(), left_tracker.last_image(),
                          left.Inverse() * kForward)
                  .size();
  state.counters["matches"] = static_cast<double>(matches);
}
BENCHMARK(MatchFisheyes)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace parkade
