#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/ingest/checks/finding.h"
#include "server/ingest/checks/gyroscope_fit.h"

namespace parkade {

/// Name of the finding whose evidence says what rates would have to be multiplied with.
inline constexpr const char *kGyroscopeGain = "gyroscope_gain", *kRateCorrection = "correction";
/// Its further evidence where rates are corrected.
inline constexpr const char* kIsCorrected = "is_corrected";
/// Names of findings about a delay between IMU and cameras.
inline constexpr const char *kImuLate = "imu_late", *kCamerasLate = "cameras_late";

/// That an axis of the gyroscope reads what the cameras see about another, with the opposite sign,
/// or not at all; else that its rates are some percent off, and that its stamps are late.
std::vector<Finding> CheckGyroscope(const GyroscopeFit& fit, const std::string& topic);

/// That the gyroscope reads a rate at rest that none should; what it read without that.
std::optional<Finding> CheckBias(const GyroscopeFit& fit, const std::string& topic);

/// The gain as an error of the cameras, where wheels turn as the IMU says.
Finding AsErrorOfLenses(const Finding& gain);

/// The delay between IMU and cameras as one of the cameras' stamps, where wheels are with the IMU.
Finding AsDelayOfCameras(const Finding& imu_late, bool has_wheels);

}  // namespace parkade
