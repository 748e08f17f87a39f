#include "server/findings/force_findings.h"

#include <algorithm>
#include <cmath>

#include "slam/factors/motion_state.h"

namespace parkade {
namespace {

const double kGravity = -kGravityInOdom.z();  // [m/s^2]

}  // namespace

std::optional<Finding> WrongForces(const OdometryReport& odometry) {
  constexpr double kLargest = 0.3;  // [m/s^2]
  const double bias = odometry.accelerometer_bias.norm();
  if (odometry.has_wheels || bias < kLargest) return std::nullopt;
  return WarningOf("accelerometer_off",
                   FormatText("the IMU's accelerations are off by %.2g m/s2: if it is a matter of "
                              "their scale, the path's is off by %.1f %%",
                              bias, 100 * bias / kGravity),
                   "calibrate the accelerometer, or record wheels", {{"bias_m_s2", bias}});
}

std::optional<Finding> WrongForceScale(const OdometryReport& odometry, const Rig& rig) {
  constexpr double kSmallest = 0.02, kLargestDifference = 0.02;  // shares
  if (!odometry.has_wheels) return std::nullopt;
  const double of_gravity =
                   (rig.body_from_imu.rotation * odometry.accelerometer_bias).z() / kGravity,
               of_path = odometry.wheel_scale - 1;
  if (std::min(std::abs(of_gravity), std::abs(of_path)) < kSmallest ||
      std::abs(of_gravity - of_path) > kLargestDifference)
    return std::nullopt;
  const double gain = 1 + (of_gravity + of_path) / 2;
  return WarningOf(
      "accelerometer_scale_off",
      FormatText(
          "the IMU reads gravity %.1f %% too %s, and the path is %.1f %% %s than wheels say: "
          "the scale of accelerations is off, as it seems, and the map's with it",
          100 * std::abs(of_gravity), of_gravity > 0 ? "large" : "small", 100 * std::abs(of_path),
          of_path > 0 ? "longer" : "shorter"),
      FormatText(
          "measure a length in the map, or the accelerations with the IMU turned over; if so, "
          "set accelerometer_scale: %.4g in imu0.yaml",
          rig.imu.accelerometer_scale / gain),
      {{"of_gravity", of_gravity}, {"of_path", of_path}});
}

}  // namespace parkade
