#pragma once

#include <ceres/sized_cost_function.h>

#include "slam/factors/node_parameters.h"

namespace parkade {

/// How still a car stands: standard deviations over one interval.
struct StandstillNoise {
  double rotation = 2e-4;  ///< [rad]
  double position = 5e-4;  ///< [m]
  double velocity = 2e-3;  ///< [m/s]
};

/// Zero velocity and zero rotation between nodes i and j (9 values):
///
///   r = [ Log(R_i^T R_j) / rotation;  (p_j - p_i) / position;  v_j / velocity ]
///
/// Parameter blocks: pose_i 7, pose_j 7, motion_j 9.
class StandstillCost final : public ceres::SizedCostFunction<9, kPoseSize, kPoseSize, kMotionSize> {
 public:
  explicit StandstillCost(const StandstillNoise& noise = {}) : noise_(noise) {}

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  StandstillNoise noise_;
};

}  // namespace parkade
