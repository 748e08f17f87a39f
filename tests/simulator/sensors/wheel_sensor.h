#pragma once

#include <cstdint>
#include <vector>

#include "core/drive_log.h"
#include "tests/simulator/motion/motion.h"
#include "tests/simulator/sensors/sensor_options.h"

namespace parkade::simulator {

/// A time in which the wheels turn faster than the car moves (or slower, ratio < 0, when braking).
struct WheelSlip {
  double begin = 0, end = 0;  ///< [s] of the drive
  double ratio = 0;           ///< of speed
};

/// The short slips of a drive: while it accelerates or brakes by more than 1 m/s^2,
/// `options.wheel_slips` a minute.
std::vector<WheelSlip> PlanSlips(const Motion& motion, const SensorOptions& options,
                                 std::uint64_t seed);

/// Wheel odometry at 100 Hz in order of time: scale error, slip with acceleration, the slips of
/// PlanSlips and `more_slips`, noise; standing wheels give exactly zero.
std::vector<WheelSample> SimulateWheels(const Motion& motion, const SensorOptions& options,
                                        std::uint64_t seed,
                                        const std::vector<WheelSlip>& more_slips = {});

}  // namespace parkade::simulator
