#pragma once

#include <vector>

#include "core/rig.h"
#include "core/trajectory.h"

namespace parkade {

class DriveMeasurements;

/// How far the wheels' speed is off that of the trajectory.
struct WheelSlip {
  Timestamp time;
  double speed = 0;  ///< [m/s] of the wheels, scale corrected, less that of the car
};

/// Compares each stretch between two nodes in which the car moved; empty without wheels.
///
/// \param rig          where the IMU sits
/// \param wheel_scale  true speed / reported speed
std::vector<WheelSlip> SlipOfWheels(const DriveMeasurements& measurements, const Rig& rig,
                                    const Trajectory& odom_from_body, double wheel_scale);

}  // namespace parkade
