#pragma once

#include <vector>

#include "tests/simulator/route.h"

namespace parkade::simulator {

/// How the driver drives.
struct SpeedOptions {
  double max_speed = 4;                   ///< [m/s]
  double max_acceleration = 1.5;          ///< [m/s^2]
  double max_deceleration = 1.8;          ///< [m/s^2]
  double max_lateral_acceleration = 2.2;  ///< [m/s^2]; slows down in curves
  double initial_stand = 2;               ///< [s] before the start
  double stop = 2.5;                      ///< [s] standing in mid-drive
  double stop_at = 0.45;                  ///< of the route's length
  double final_stand = 1;                 ///< [s]
};

/// Distance travelled over time, C2-smooth, non-decreasing; stands at both ends.
class SpeedProfile {
 public:
  /// As fast as the limits allow over the whole route.
  SpeedProfile(const Route& route, const SpeedOptions& options);

  double Duration() const { return step_ * static_cast<double>(distances_.size() - 1); }  ///< [s]
  double Distance(double time) const;                                                     ///< [m]
  double Speed(double time) const;                                                        ///< [m/s]
  double Acceleration(double time) const;                                                 ///< [m/s^2]

 private:
  double step_ = 0.005;  ///< [s]
  std::vector<double> distances_;
};

}  // namespace parkade::simulator
