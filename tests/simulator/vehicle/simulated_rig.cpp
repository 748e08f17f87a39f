#include "tests/simulator/vehicle/simulated_rig.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "core/error.h"
#include "tests/simulator/common/random.h"
#include "tests/simulator/vehicle/car_mesh.h"
#include "tests/simulator/vehicle/lens_models.h"

namespace parkade::simulator {
namespace {

/// Where a camera sits and looks: yaw to the left, then pitch down.
struct Mounting {
  Eigen::Vector3d position;  ///< [m] in body
  double yaw_deg, pitch_down_deg;
};

const std::array<Mounting, 4>& Mountings() {
  static const std::array<Mounting, 4> mountings = {{{{3.27, 0.00, 0.64}, 0, 22},
                                                     {{2.02, 0.99, 0.92}, 84, 38},
                                                     {{2.02, -0.99, 0.92}, -84, 38},
                                                     {{-0.76, 0.00, 0.96}, 180, 26}}};
  return mountings;
}

/// Camera axes (z forward, x right, y down) in a body that looks along x.
Eigen::Quaterniond BodyFromForwardCamera() {
  Eigen::Matrix3d axes;
  axes << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return Eigen::Quaterniond(axes);
}

Eigen::Vector3d Scatter(Random& random, double sigma) {
  return sigma * Eigen::Vector3d(random.Normal(), random.Normal(), random.Normal());
}

RigCamera MakeCamera(size_t index, const RigOptions& options, Random& random) {
  const Mounting& mounting = Mountings()[index];
  const Eigen::AngleAxisd yaw(mounting.yaw_deg * M_PI / 180, Eigen::Vector3d::UnitZ());
  const Eigen::AngleAxisd pitch(mounting.pitch_down_deg * M_PI / 180, Eigen::Vector3d::UnitY());
  RigCamera camera;
  camera.name = "cam" + std::to_string(index);
  camera.topic = "/" + camera.name + "/image_raw";
  camera.body_from_camera.rotation =
      (yaw * pitch * BodyFromForwardCamera() * ExpSo3(Scatter(random, 0.008))).normalized();
  camera.body_from_camera.translation = mounting.position + Scatter(random, 0.003);
  camera.line_delay = options.line_delay;
  const double scale = options.width / 640.0;
  KannalaBrandtProjection lens;
  lens.fx = scale * (198 + 0.8 * random.Normal());
  lens.fy = lens.fx * (1 + 2e-4 * random.Normal());
  lens.cx = (options.width - 1) / 2.0 + scale * 1.5 * random.Normal();
  lens.cy = (options.height - 1) / 2.0 + scale * 1.5 * random.Normal();
  lens = {.fx = lens.fx,
          .fy = lens.fy,
          .cx = lens.cx,
          .cy = lens.cy,
          .k1 = -0.016 + 5e-4 * random.Normal(),
          .k2 = 0.0021,
          .k3 = -0.0011,
          .k4 = 0.00012};
  camera.model = CameraModel(LensLike(lens, options.lens), options.width, options.height);
  return camera;
}

}  // namespace

void RigOptions::Validate() const {
  Require(width >= 64 && width <= 4096 && height >= 64 && height <= 4096, ErrorCode::kUsage,
          "the image size must be within 64x64 and 4096x4096");
  Require(num_cameras >= 1 && num_cameras <= 4, ErrorCode::kUsage,
          "the number of cameras must be 1 to 4");
  Require(line_delay >= 0 && line_delay * height < 0.1, ErrorCode::kUsage,
          "the line delay must be 0 or more, and an image must take less than 0.1 s");
  const auto& lenses = LensNames();
  Require(std::find(lenses.begin(), lenses.end(), lens) != lenses.end(), ErrorCode::kUsage,
          "rig.lens must be kb, omni, eucm, ds or ocam");
}

Rig MakeSimulatedRig(const RigOptions& options, std::uint64_t seed) {
  options.Validate();
  Random random(seed, 0x216);
  Rig rig;
  for (size_t i = 0; i < 4; ++i) {
    const RigCamera camera = MakeCamera(i, options, random);
    if (static_cast<int>(i) < options.num_cameras) rig.cameras.push_back(camera);
  }
  rig.body_from_imu.rotation = ExpSo3(Scatter(random, 0.02));
  rig.body_from_imu.translation = Eigen::Vector3d(0.62, 0.11, 0.48) + Scatter(random, 0.004);
  rig.imu.topic = "/imu/data";
  rig.imu.update_rate = 100;
  rig.imu.accelerometer_noise_density = 2.5e-3;
  rig.imu.accelerometer_random_walk = 2e-4;
  rig.imu.gyroscope_noise_density = 2e-4;
  rig.imu.gyroscope_random_walk = 5e-6;
  VehicleCalibration vehicle;
  vehicle.wheelbase = Wheelbase(kOwnCarStyle);
  vehicle.track = 1.48;
  vehicle.wheel_topic = "/vehicle/odometry";
  vehicle.gnss_topic = "/gnss/fix";
  vehicle.antenna_in_body = Eigen::Vector3d(0.35, 0.02, 1.51);
  rig.vehicle = vehicle;
  return rig;
}

SiteDatum SimulatedDatum() { return {48.137154, 11.576124, 519.3}; }

}  // namespace parkade::simulator
