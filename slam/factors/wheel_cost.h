#pragma once

#include <ceres/sized_cost_function.h>

#include "slam/factors/node_parameters.h"
#include "slam/factors/wheel_preintegration.h"

namespace parkade {

/// Relative displacement of the body origin between nodes i and j (3 values):
///
///   r = S [ R_i^T (p_j + R_j l - p_i - R_i l) - (1 + s) d(b_gi) ]
///
/// d: preintegrated gyro-odometer displacement; l: body origin in imu; s: wheel
/// scale error. Also the non-holonomic constraint: across the car d is zero.
/// Parameter blocks: pose_i 7, motion_i 9, pose_j 7, wheel_scale 1.
class WheelCost final : public ceres::SizedCostFunction<3, kPoseSize, kMotionSize, kPoseSize, 1> {
 public:
  explicit WheelCost(const WheelPreintegration& preintegration);

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  WheelPreintegration preintegration_;
  Eigen::Matrix3d sqrt_information_;
};

}  // namespace parkade
