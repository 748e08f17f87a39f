#include "core/rig.h"

#include <cmath>
#include <set>

#include "core/error.h"

namespace parkade {
namespace {

constexpr double kLargestCar = 50;  // [m] beyond which a mount is in other units, or nonsense

void RequireRigid(const Rigid3& motion, const std::string& name) {
  Require(motion.translation.allFinite() && motion.rotation.coeffs().allFinite(),
          ErrorCode::kInvalidInput, name + " holds a number that is not finite");
  Require(std::abs(motion.rotation.norm() - 1) < 1e-6, ErrorCode::kInvalidInput,
          name + " is not a rigid motion");
  const double distance = motion.translation.norm();
  Require(distance <= kLargestCar, ErrorCode::kInvalidInput,
          name + " lies " + std::to_string(std::lround(distance)) +
              " m from the middle of the rear axle, beyond any car: lengths are in meters");
}

void RequirePositive(double value, const std::string& name) {
  Require(value > 0 && std::isfinite(value), ErrorCode::kInvalidInput,
          name + " must be a positive number");
}

void RequireLength(double value, const std::string& name) {
  Require(value >= 0 && std::isfinite(value), ErrorCode::kInvalidInput,
          name + " must be a length in meters");
}

void ValidateCamera(const RigCamera& camera) {
  Require(!camera.name.empty(), ErrorCode::kInvalidInput, "a camera has no name");
  Require(camera.model.width() > 0, ErrorCode::kInvalidInput,
          camera.name + " has no calibrated lens");
  RequireRigid(camera.body_from_camera, "the mounting of " + camera.name);
  Require(std::isfinite(camera.time_shift) && std::abs(camera.time_shift) < 10,
          ErrorCode::kInvalidInput, "the time shift of " + camera.name + " is not within 10 s");
  Require(
      std::isfinite(camera.line_delay) && std::abs(camera.line_delay) * camera.model.height() < 1,
      ErrorCode::kInvalidInput,
      "the line delay of " + camera.name + " makes an image longer than 1 s");
  if (camera.mask.empty()) return;
  Require(camera.mask.type() == CV_8UC1, ErrorCode::kInvalidInput,
          "the mask of " + camera.name + " is not gray");
  Require(camera.mask.cols == camera.model.width() && camera.mask.rows == camera.model.height(),
          ErrorCode::kInvalidInput,
          "the mask of " + camera.name + " has another size than its image");
}

}  // namespace

bool RigCamera::IsUsable(const Eigen::Vector2d& pixel, double margin) const {
  if (!model.IsInImage(pixel, margin)) return false;
  return mask.empty() || mask.at<uchar>(static_cast<int>(std::lround(pixel.y())),
                                        static_cast<int>(std::lround(pixel.x()))) > 0;
}

void ValidateRig(const Rig& rig) {
  Require(!rig.cameras.empty(), ErrorCode::kInvalidInput, "the rig has no camera");
  RequireRigid(rig.body_from_imu, "the mounting of the IMU");  // first: cameras are mounted on it
  std::set<std::string> names, topics;
  for (const RigCamera& camera : rig.cameras) {
    ValidateCamera(camera);
    Require(names.insert(camera.name).second, ErrorCode::kInvalidInput,
            "two cameras are called " + camera.name);
    Require(camera.topic.empty() || topics.insert(camera.topic).second, ErrorCode::kInvalidInput,
            "two cameras have the topic '" + camera.topic + "'");
  }
  RequirePositive(rig.imu.update_rate, "update_rate of the IMU");
  RequirePositive(rig.imu.accelerometer_scale, "accelerometer_scale of the IMU");
  RequirePositive(rig.imu.gyroscope_scale, "gyroscope_scale of the IMU");
  RequirePositive(rig.imu.accelerometer_noise_density, "accelerometer_noise_density of the IMU");
  RequirePositive(rig.imu.accelerometer_random_walk, "accelerometer_random_walk of the IMU");
  RequirePositive(rig.imu.gyroscope_noise_density, "gyroscope_noise_density of the IMU");
  RequirePositive(rig.imu.gyroscope_random_walk, "gyroscope_random_walk of the IMU");
  if (!rig.vehicle) return;
  RequireLength(rig.vehicle->wheelbase, "wheelbase of the vehicle");
  RequireLength(rig.vehicle->track, "track of the vehicle");
  Require(std::isfinite(rig.vehicle->wheel_scale) && rig.vehicle->wheel_scale != 0,
          ErrorCode::kInvalidInput, "wheel_scale of the vehicle must be a number, and not 0");
  Require(!rig.vehicle->antenna_in_body || rig.vehicle->antenna_in_body->allFinite(),
          ErrorCode::kInvalidInput, "p_body_gnss of the vehicle holds a number that is not finite");
}

}  // namespace parkade
