#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/rig.h"
#include "server/ingest/schemas/signal_reader.h"

namespace parkade {

// Signals of a field map as ROS messages (CDR).

/// A sensor_msgs/Imu without a frame.
std::vector<std::uint8_t> ImuFromSignals(const SignalValues& values, Timestamp time);

/// A sensor_msgs/NavSatFix; without `sigma_horizontal`, of unknown covariance.
std::vector<std::uint8_t> FixFromSignals(const SignalValues& values, Timestamp time);

/// Makes wheel odometry of one pass.
class WheelSignals {
 public:
  explicit WheelSignals(const VehicleCalibration& vehicle);

  /// A geometry_msgs/TwistStamped. Of ticks: between the last message and this one, at the time
  /// midway; nothing for the first, and where a counter begins anew.
  std::optional<std::vector<std::uint8_t>> Convert(const SignalValues& values, Timestamp time);

 private:
  struct Ticks {
    Timestamp time;
    double left = 0, right = 0;
  };

  double track_, wheelbase_, meters_per_tick_;  ///< [m]
  std::optional<Ticks> last_;
};

/// Throws Error{kInvalidInput} where vehicle.yaml lacks the length that signals of wheels need.
void RequireLengths(const VehicleCalibration& vehicle);

}  // namespace parkade
