#pragma once

#include <Eigen/Core>
#include <vector>

#include "slam/factors/imu_cost.h"

namespace parkade {

/// What an IMU reads is a matrix times what it feels: nine numbers off unity for the gyroscope,
/// nine for the accelerometer, in no data sheet of a single device and too weak to be estimated in
/// one drive, but the same all the way.
inline constexpr int kImuSensitivities = 18;

/// d (J^T r) / d (these numbers in units of their standard deviations), 30 x 18: how they push the
/// states of an IMU factor. A wrong sensitivity acts as a bias that goes with the mean rate and the
/// mean force of the interval. `parameters` are the four blocks of `cost`.
Eigen::MatrixXd ScoreSensitivity(const ImuCost& cost, const ImuPreintegration& imu,
                                 const std::vector<const double*>& parameters);

}  // namespace parkade
