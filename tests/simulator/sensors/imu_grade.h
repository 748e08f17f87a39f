#pragma once

#include <string>

#include "core/rig.h"

namespace parkade::simulator {

/// What a kind of IMU does wrong. The densities are what imu0.yaml says; the rest is for the
/// estimator to find out.
struct ImuGrade {
  std::string name;
  double accelerometer_noise_density,
      accelerometer_random_walk;                          ///< [m/s^2/sqrt(Hz)], [m/s^3/sqrt(Hz)]
  double gyroscope_noise_density, gyroscope_random_walk;  ///< [rad/s/sqrt(Hz)], [rad/s^2/sqrt(Hz)]
  double accelerometer_bias, gyroscope_bias;  ///< [m/s^2], [rad/s] at switching on, per axis
  double scale_error;                         ///< of each axis
  double misalignment;                        ///< [rad] of each axis toward the others
};

/// "rt3000" (of the class of an OxTS RT3000) or "mems". Throws Error{kUsage} for any other name.
const ImuGrade& ImuGradeNamed(const std::string& name);

/// What imu0.yaml says of an IMU of this kind.
ImuCalibration CalibrationOf(const ImuGrade& grade, double rate, const std::string& topic);

}  // namespace parkade::simulator
