#pragma once

#include <optional>
#include <string>

#include "core/rig.h"
#include "server/ingest/checks/finding.h"
#include "server/ingest/checks/gyroscope_history.h"
#include "server/ingest/checks/speed_history.h"

namespace parkade {

// Names of findings about wheels. Those that are zero, coarse, blind or stick are left out.
inline constexpr const char* kWheelsAreZero = "wheels_zero";
inline constexpr const char* kWheelsAreCoarse = "wheels_coarse";
inline constexpr const char* kWheelsAreBlind = "wheels_blind";
inline constexpr const char* kWheelsStick = "wheels_stick";
inline constexpr const char* kWheelsLate = "wheels_late";

/// That wheels say 0 m/s from beginning to end or below some speed, or come in steps too coarse to
/// be worth anything.
std::optional<Finding> CheckSpeeds(const SpeedHistory& wheels, const std::string& topic);

/// That wheels repeat one speed to the last bit while others never do, or say that the car stands
/// while cameras see it move.
/// \param num_moving  moments in which they do (CameraChecks::NumMovingAtRest)
std::optional<Finding> CheckSticking(const SpeedHistory& wheels, int num_moving,
                                     const std::string& topic);

/// How late wheels are stamped against the gyroscope, by the turns that both report, and how much
/// they turn.
struct WheelDelay {
  double seconds = 0, sigma = 0;
  double gain = 1;  ///< of wheels over gyroscope
};

/// The delay with which yaw rates of wheels are most like those of the gyroscope, up to a gain and
/// a bias; nothing where the car hardly turned, or they are not alike.
std::optional<WheelDelay> FitWheelDelay(const Rig& rig, const GyroscopeHistory& gyroscope,
                                        const SpeedHistory& wheels);

/// \param imu_delay  [s] by which the IMU's stamps are late themselves
std::optional<Finding> CheckWheelDelay(const WheelDelay& against_imu, double imu_delay,
                                       const std::string& topic);

}  // namespace parkade
