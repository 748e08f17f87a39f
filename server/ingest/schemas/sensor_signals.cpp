#include "server/ingest/schemas/sensor_signals.h"

#include <cmath>
#include <limits>

#include "core/error.h"
#include "server/ingest/messages/message_encoding.h"

namespace parkade {
namespace {

std::vector<std::uint8_t> Twist(Timestamp time, double speed, double yaw_rate) {
  return EncodeTwist({time, speed, yaw_rate}, "");
}

}  // namespace

std::vector<std::uint8_t> ImuFromSignals(const SignalValues& values, Timestamp time) {
  const auto vector = [&](const std::string& name) {
    return Eigen::Vector3d(values.at(name + "_x"), values.at(name + "_y"), values.at(name + "_z"));
  };
  return EncodeImu({time, vector("rate"), vector("acceleration")}, "");
}

std::vector<std::uint8_t> FixFromSignals(const SignalValues& values, Timestamp time) {
  const auto value_or = [&](const char* name, double otherwise) {
    const auto found = values.find(name);
    return found == values.end() ? otherwise : found->second;
  };
  const double horizontal = value_or("sigma_horizontal", 0);
  const double vertical = value_or("sigma_vertical", 2 * horizontal);
  const double h = horizontal * horizontal, v = vertical * vertical;
  constexpr int kUnknown = 0, kDiagonalKnown = 2;
  return EncodeNavSat({.header = {time, ""},
                       .status = 0,
                       .latitude_deg = values.at("latitude"),
                       .longitude_deg = values.at("longitude"),
                       .altitude = value_or("altitude", std::numeric_limits<double>::quiet_NaN()),
                       .covariance = {h, 0, 0, 0, h, 0, 0, 0, v},
                       .covariance_type = h > 0 ? kDiagonalKnown : kUnknown});
}

WheelSignals::WheelSignals(const VehicleCalibration& vehicle)
    : track_(vehicle.track),
      wheelbase_(vehicle.wheelbase),
      meters_per_tick_(vehicle.fields.meters_per_tick) {}

std::optional<std::vector<std::uint8_t>> WheelSignals::Convert(const SignalValues& values,
                                                               Timestamp time) {
  if (values.contains("yaw_rate")) return Twist(time, values.at("speed"), values.at("yaw_rate"));
  if (values.contains("steering_angle")) {
    const double speed = values.at("speed");
    return Twist(time, speed, speed * std::tan(values.at("steering_angle")) / wheelbase_);
  }
  if (values.contains("speed_left")) {
    const double left = values.at("speed_left"), right = values.at("speed_right");
    return Twist(time, (left + right) / 2, (right - left) / track_);
  }
  const Ticks now{time, values.at("ticks_left"), values.at("ticks_right")};
  const std::optional<Ticks> last = std::exchange(last_, now);
  if (!last || now.time <= last->time) return std::nullopt;
  const double seconds = now.time - last->time;
  const double left = (now.left - last->left) * meters_per_tick_ / seconds;
  const double right = (now.right - last->right) * meters_per_tick_ / seconds;
  constexpr double kMaxSpeed = 100;  // [m/s] beyond, the counter began anew
  if (std::max(std::abs(left), std::abs(right)) > kMaxSpeed) return std::nullopt;
  return Twist(last->time + seconds / 2, (left + right) / 2, (right - left) / track_);
}

void RequireLengths(const VehicleCalibration& vehicle) {
  const FieldSignals& wheels = vehicle.fields.wheels;
  const bool has_yaw_rate = wheels.contains("speed") && wheels.contains("yaw_rate");
  if (wheels.empty() || has_yaw_rate) return;
  const bool is_steered = wheels.contains("speed") && wheels.contains("steering_angle");
  Require((is_steered ? vehicle.wheelbase : vehicle.track) > 0, ErrorCode::kInvalidInput,
          std::string("the field map of vehicle.yaml needs its ") +
              (is_steered ? "'wheelbase'" : "'track'") + " for the yaw rate");
}

}  // namespace parkade
