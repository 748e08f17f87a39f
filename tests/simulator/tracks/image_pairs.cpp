#include "tests/simulator/tracks/image_pairs.h"

#include <opencv2/imgcodecs.hpp>

#include "tests/simulator/drives/plan_drive.h"
#include "tests/simulator/render/renderer.h"
#include "tests/simulator/scenes/build_scene.h"
#include "tests/simulator/scenes/traffic.h"

namespace parkade::simulator {
namespace {

cv::Mat AsRead(const cv::Mat& image, int jpeg_quality) {
  return cv::imdecode(EncodeJpeg(image, jpeg_quality), cv::IMREAD_GRAYSCALE);
}

}  // namespace

void TakeImagePairs(const SimulateOptions& options, const PairOptions& pairs,
                    const std::function<void(const ImagePair&)>& take) {
  options.Validate();
  const std::uint64_t seed = static_cast<std::uint64_t>(options.seed);
  Scene scene = BuildScene(options.scene, options.OfScene());
  const Rig rig = MakeSimulatedRig(options.rig, seed);
  const DrivePlan plan = PlanDrive(scene.place, options.drive, options.duration, seed);
  AddTraffic(scene, plan.motion, options.traffic, seed);
  const Renderer renderer(scene, rig, kHalfFieldOfView);
  ImageSensorOptions image = options.image;
  if (image.exposure == 0) image.exposure = scene.usual_exposure;
  for (double time = pairs.every; time < plan.motion.Duration() - 1; time += pairs.every) {
    const auto moving = plan.motion.At(time);
    if (moving.velocity_in_world.norm() < pairs.slowest) continue;
    for (size_t camera = 0; camera < rig.cameras.size(); ++camera) {
      ImageSensor sensor(image, Mix64(seed) + camera);
      const auto image_at = [&](double moment) {
        Shot shot;
        shot.camera = camera;
        shot.exposure = image.exposure;
        shot.time = moment;
        shot.world_from_body = [&plan, moment](double offset) {
          return plan.motion.WorldFromBody(moment + offset);
        };
        return AsRead(sensor.Develop(renderer.Render(shot).radiance), image.jpeg_quality);
      };
      ImagePair pair;
      pair.camera = camera;
      pair.time = time;
      pair.speed = moving.velocity_in_world.norm();
      pair.turn_rate = moving.angular_velocity_in_body.norm();
      pair.before = image_at(time);
      pair.after = image_at(time + 1 / options.cameras.rate);
      pair.followed = FollowCorners(pair.before, pair.after, renderer.Mask(camera));
      take(pair);
    }
  }
}

}  // namespace parkade::simulator
