#include "tests/bench/odometry/odometry_cases.h"

namespace parkade {
namespace {

using simulator::FaultOptions;

void SetRigError(FaultOptions& faults, double degrees, double centimeters) {
  faults.extrinsic_rotation_deg = {degrees};
  faults.extrinsic_translation_cm = {centimeters};
}

}  // namespace

std::vector<StatisticsCase> StandardCases(const std::string& scene, double duration) {
  StatisticsCase plain;
  plain.drive.drive.scene = scene;
  plain.drive.drive.duration = duration;
  plain.drive.drive.sensors.has_wheels = false;
  plain.drive.drive.sensors.gnss = "none";
  plain.name = "cameras and IMU";
  std::vector<StatisticsCase> cases;
  const auto add = [&](const std::string& name, const auto& change) {
    cases.push_back(plain);
    cases.back().name = name;
    change(cases.back());
  };
  const double middle = duration / 2;
  add("exact", [](StatisticsCase&) {});
  add("off-small", [](StatisticsCase& c) { SetRigError(c.drive.drive.faults, 0.3, 1); });
  add("off-large", [](StatisticsCase& c) { SetRigError(c.drive.drive.faults, 1, 3); });
  add("front-only", [](StatisticsCase& c) { c.drive.drive.rig.num_cameras = 1; });
  add("front-only-off-large", [](StatisticsCase& c) {
    c.drive.drive.rig.num_cameras = 1;
    SetRigError(c.drive.drive.faults, 1, 3);
  });
  add("wheels", [](StatisticsCase& c) { c.drive.drive.sensors.has_wheels = true; });
  add("wheels-off-small", [](StatisticsCase& c) {
    c.drive.drive.sensors.has_wheels = true;
    SetRigError(c.drive.drive.faults, 0.3, 1);
  });
  add("time-offset", [](StatisticsCase& c) {
    c.drive.drive.faults.time_offsets = {0.03, -0.03, 0.02, -0.01};
  });
  add("rolling-shutter", [](StatisticsCase& c) { c.drive.drive.rig.line_delay = 3e-5; });
  add("rolling-shutter-unknown", [](StatisticsCase& c) {
    c.drive.drive.rig.line_delay = 3e-5;
    c.drive.drive.faults.hides_line_delay = true;
  });
  add("rt3000", [](StatisticsCase& c) { c.drive.drive.sensors.imu = "rt3000"; });
  add("start-rolling", [](StatisticsCase& c) { c.start = "rolling"; });
  add("start-turning", [](StatisticsCase& c) { c.start = "turning"; });
  add("start-rolling-wheels", [](StatisticsCase& c) {
    c.drive.drive.sensors.has_wheels = true;
    c.start = "rolling";
  });
  add("camera-gone", [&](StatisticsCase& c) {
    c.drive.drive.faults.image_gap = {0, middle / 2, duration};
  });
  add("dark-5s", [&](StatisticsCase& c) { c.drive.drive.faults.darkness = {middle, middle + 5}; });
  add("dark-5s-wheels", [&](StatisticsCase& c) {
    c.drive.drive.sensors.has_wheels = true;
    c.drive.drive.faults.darkness = {middle, middle + 5};
  });
  add("slip-wheels", [&](StatisticsCase& c) {
    c.drive.drive.sensors.has_wheels = true;
    c.drive.drive.faults.slip = {middle, middle + 3, 0.5};
  });
  add("imu-gap-0.4s", [&](StatisticsCase& c) {
    c.drive.drive.faults.imu_gap = {middle, middle + 0.4};
  });
  add("imu-gap-1s-wheels", [&](StatisticsCase& c) {
    c.drive.drive.sensors.has_wheels = true;
    c.drive.drive.faults.imu_gap = {middle, middle + 1};
  });
  add("mirror-knocked", [&](StatisticsCase& c) { c.drive.drive.faults.mirror = {1, middle, 4}; });
  add("traffic-stop", [&](StatisticsCase& c) {
    c.drive.drive.traffic = 12;
    c.drive.drive.drive.stops = {duration / 3};
  });
  return cases;
}

}  // namespace parkade
