#pragma once

#include <ceres/sized_cost_function.h>

#include "slam/first_estimate.h"
#include "slam/imu_preintegration.h"

namespace parkade {

/// Preintegrated IMU factor between knots i and j (15 values):
///
///   r = S [ Log(dR(b_i)^T R_i^T R_j)
///           R_i^T (v_j - v_i - g t) - dv(b_i)
///           R_i^T (p_j - p_i - v_i t - g t^2/2) - dp(b_i)
///           b_gj - b_gi
///           b_aj - b_ai ],      S^T S = covariance^-1
///
/// Parameter blocks: pose_i 7, motion_i 9, pose_j 7, motion_j 9.
/// C. Forster et al., TRO 2017, eqs. 44-45. Jacobians at first estimates where
/// a knot has one. `preintegration` and the first estimates are borrowed and
/// may be null / must outlive the cost.
class ImuCost final : public ceres::SizedCostFunction<15, kPoseSize, kMotionSize, kPoseSize, kMotionSize> {
 public:
  ImuCost(const ImuPreintegration* preintegration, const FirstEstimate* first_i, const FirstEstimate* first_j);

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;
  const ImuPreintegration& preintegration() const { return *preintegration_; }

 private:
  using Vector15d = Eigen::Matrix<double, 15, 1>;

  Vector15d Residual(const MotionState& i, const MotionState& j) const;
  void FillJacobians(const MotionState& i, const MotionState& j, double** jacobians) const;

  const ImuPreintegration* preintegration_;
  const FirstEstimate* first_i_;
  const FirstEstimate* first_j_;
  Eigen::Matrix<double, 9, 9> sqrt_information_;
  double gyroscope_weight_;
  double accelerometer_weight_;
};

}  // namespace parkade
