#pragma once

#include <ceres/sized_cost_function.h>

#include "slam/factors/imu_preintegration.h"
#include "slam/factors/node_parameters.h"

namespace parkade {

/// Preintegrated IMU factor between nodes i and j (15 values):
///
///   r = S [ Log(dR(b_i)^T R_i^T R_j)
///           R_i^T (v_j - v_i - g t) - dv(b_i)
///           R_i^T (p_j - p_i - v_i t - g t^2/2) - dp(b_i)
///           b_gj - b_gi
///           b_aj - b_ai ],      S^T S = covariance^-1
///
/// Parameter blocks: pose_i 7, motion_i 9, pose_j 7, motion_j 9.
/// C. Forster et al., TRO 2017, eqs. 44-45. `preintegration` is borrowed and must outlive the cost.
class ImuCost final
    : public ceres::SizedCostFunction<15, kPoseSize, kMotionSize, kPoseSize, kMotionSize> {
 public:
  explicit ImuCost(const ImuPreintegration* preintegration);

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;
  const ImuPreintegration& preintegration() const { return *preintegration_; }

 private:
  using Vector15d = Eigen::Matrix<double, 15, 1>;

  Vector15d Residual(const MotionState& i, const MotionState& j) const;
  void FillJacobians(const MotionState& i, const MotionState& j, double** jacobians) const;

  const ImuPreintegration* preintegration_;
  Eigen::Matrix<double, 9, 9> sqrt_information_;
  double gyroscope_weight_;
  double accelerometer_weight_;
};

}  // namespace parkade
