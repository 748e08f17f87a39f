#include "tests/simulator/tracks/track_rendered.h"

#include <chrono>
#include <cmath>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "slam/tracking/cross_camera_matcher.h"
#include "tests/simulator/render/image_sensor.h"
#include "tests/simulator/render/renderer.h"
#include "tests/simulator/tracks/track_crossing.h"
#include "tests/simulator/tracks/track_eye.h"
#include "tests/simulator/vehicle/simulated_rig.h"

namespace parkade::simulator {
namespace {

double Now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// As from a log: JPEG there and back.
cv::Mat Image(const Renderer& renderer, ImageSensor& sensor, const TrackEye& eye, double exposure,
              const ScheduledFrame& frame) {
  Shot shot;
  shot.camera = frame.camera;
  shot.world_from_body = [&](double offset) { return eye.WorldFromBody(frame.time + offset); };
  shot.exposure = exposure;
  shot.time = eye.SecondsOf(frame.time);
  const std::vector<std::uint8_t> jpeg =
      EncodeJpeg(sensor.Develop(renderer.Render(shot).radiance), ImageSensorOptions{}.jpeg_quality);
  return cv::imdecode(jpeg, cv::IMREAD_GRAYSCALE);
}

}  // namespace

RenderedTracks TrackRenderedDrive(const Scene& scene, const Rig& rig_without_masks,
                                  const Motion& motion, const Stretch& stretch, std::uint64_t seed,
                                  const FeatureTrackerOptions& options) {
  Rig rig = rig_without_masks;
  const Renderer renderer(scene, rig, kHalfFieldOfView);
  for (size_t camera = 0; camera < rig.cameras.size(); ++camera)
    rig.cameras[camera].mask = renderer.Mask(camera);
  const Timestamp epoch = DriveEpoch(seed);
  std::vector<ImageSensor> sensors;
  std::vector<std::unique_ptr<FeatureTracker>> trackers;
  std::vector<TrackEye> eyes;
  for (size_t camera = 0; camera < rig.cameras.size(); ++camera) {
    sensors.emplace_back(ImageSensorOptions{}, seed + camera);
    trackers.push_back(
        std::make_unique<FeatureTracker>(rig.cameras[camera], static_cast<int>(camera), options));
    eyes.emplace_back(motion, epoch, rig.cameras[camera]);
  }
  const std::vector<CameraPair> pairs = OverlappingPairs(rig);

  RenderedTracks result;
  std::vector<TrackedImage> last(rig.cameras.size());
  std::vector<size_t> last_index(rig.cameras.size());  // into result.frames
  for (const ScheduledFrame& frame :
       ScheduleFrames(motion, rig.cameras.size(), stretch.cameras, 0.1, seed)) {
    const double time = frame.time - epoch;
    if (time < stretch.begin || time > stretch.end) continue;
    const double begin = Now();
    const cv::Mat image =
        Image(renderer, sensors[frame.camera], eyes[frame.camera], scene.usual_exposure, frame);
    const double middle = Now();
    result.render_seconds += middle - begin;
    const TrackEye& eye = eyes[frame.camera];
    TrackedImage& before = last[frame.camera];
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
    if (!before.empty())
      rotation = (eye.WorldFromCamera(frame.time).rotation.conjugate() *
                  eye.WorldFromCamera(before.time).rotation)
                     .toRotationMatrix();
    result.frames.push_back(trackers[frame.camera]->Track(
        {frame.time, static_cast<int>(frame.camera), image}, rotation));
    before = trackers[frame.camera]->last_image();
    result.track_seconds += Now() - middle;
    result.crossed.emplace_back();
    last_index[frame.camera] = result.crossed.size() - 1;
    for (const CameraPair& pair : pairs) {
      if (pair.to != frame.camera && pair.from != frame.camera) continue;
      const TrackedImage &from = last[pair.from], &to = last[pair.to];
      if (from.empty() || to.empty() || std::abs(from.time - to.time) > kMaxPairTime) continue;
      const Rigid3 to_from_from = eyes[pair.to].WorldFromCamera(to.time).Inverse() *
                                  eyes[pair.from].WorldFromCamera(from.time);
      const std::vector<FeatureObservation> matches = MatchAcross(from, to, to_from_from);
      auto& crossed = result.crossed[last_index[pair.to]];
      crossed.insert(crossed.end(), matches.begin(), matches.end());
    }
  }
  const double num_images = std::max<double>(1, static_cast<double>(result.frames.size()));
  result.render_seconds /= num_images;
  result.track_seconds /= num_images;
  return result;
}

}  // namespace parkade::simulator
