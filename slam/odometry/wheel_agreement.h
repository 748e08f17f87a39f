#pragma once

#include <string>
#include <vector>

#include "core/drive_log.h"
#include "core/trajectory.h"

namespace parkade {

/// How wheel odometry agrees with a trajectory.
struct WheelAgreement {
  int num_moving = 0;  ///< samples while the wheels or the trajectory say that the car moves
  double scale = 1;    ///< the car's speed / that of the wheels, by the samples' medians
  double error = 0;    ///< median difference of the scaled speeds, as a share of their median
  double lasting_error =
      0;                   ///< [m/s] of the scaled speeds over thirds of a second; most are smaller
  double delay = 0;        ///< [s] by which the wheels' stamps are late, where that shows
  double correlation = 1;  ///< of both forward speeds
  double wheel_speed = 0;  ///< [m/s] median of the wheels' while moving, without sign
  double speed = 0;        ///< [m/s] the same of the trajectory's

  /// Whether the wheels may be believed: the scale is that of worn or new tires, all along.
  bool Fits() const;
  /// Where they do not fit the trajectory, what it looks like and what to do: "say 0 m/s while the
  /// car moves: check ...".
  std::string Doubt() const;
};

/// Compares speeds along the body's x axis. Few moving samples agree with anything.
WheelAgreement CompareWheels(const Trajectory& odom_from_body,
                             const std::vector<WheelSample>& wheels);

}  // namespace parkade
