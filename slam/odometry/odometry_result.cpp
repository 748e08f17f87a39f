#include "slam/odometry/odometry_result.h"

#include <nlohmann/json.hpp>

namespace parkade {
namespace {

nlohmann::json ToJson(const Eigen::Vector3d& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

nlohmann::json ToJson(const CameraCalibration& calibration) {
  nlohmann::json quantities;
  for (const CalibratedQuantity& quantity : calibration.quantities)
    quantities[quantity.name] = {
        {"status", ToText(quantity.status)},
        {"change", std::vector<double>(quantity.change.begin(), quantity.change.end())},
        {"sigma", std::vector<double>(quantity.sigma.begin(), quantity.sigma.end())}};
  return {{"name", calibration.name}, {"quantities", quantities}};
}

}  // namespace

std::string ToText(CalibratedQuantity::Status status) {
  switch (status) {
    case CalibratedQuantity::Status::kKept: return "kept";
    case CalibratedQuantity::Status::kPartlyRefined: return "partly refined";
    case CalibratedQuantity::Status::kRefined: return "refined";
  }
  return "unknown";
}

nlohmann::json ToJson(const OdometryReport& report) {
  nlohmann::json cameras = nlohmann::json::array(), calibration = nlohmann::json::array(),
                 degraded = nlohmann::json::array();
  for (const CameraCalibration& camera : report.calibration) calibration.push_back(ToJson(camera));
  for (const CameraHealth& camera : report.cameras)
    cameras.push_back({{"name", camera.name},
                       {"frames", camera.frames},
                       {"frames_used", camera.frames_used},
                       {"frames_rejected", camera.frames_rejected},
                       {"tracks_per_frame", camera.tracks_per_frame},
                       {"noise_scale", camera.noise_scale}});
  for (const DegradedInterval& interval : report.degraded)
    degraded.push_back({{"begin", ToDecimalSeconds(interval.begin)},
                        {"end", ToDecimalSeconds(interval.end)},
                        {"reason", interval.reason}});
  return {{"start",
           {{"kind", report.start_kind}, {"time", report.start_time}, {"data", report.start_data}}},
          {"cameras", cameras},
          {"calibration", calibration},
          {"degraded", degraded},
          {"knots", report.nodes},
          {"solves", report.solves},
          {"mean_solve_seconds", report.mean_solve_seconds},
          {"max_solve_seconds", report.max_solve_seconds},
          {"mean_bearings", report.mean_bearings},
          {"seconds", report.seconds},
          {"length", report.length},
          {"still_seconds", report.still_seconds},
          {"has_wheels", report.has_wheels},
          {"wheel_scale", report.wheel_scale},
          {"wheels_left_out", report.wheels_left_out},
          {"gyroscope_bias", ToJson(report.gyroscope_bias)},
          {"accelerometer_bias", ToJson(report.accelerometer_bias)}};
}

}  // namespace parkade
