#pragma once

#include <ceres/sized_cost_function.h>

#include "slam/factors/node_parameters.h"
#include "slam/smoother/smoother_options.h"

namespace parkade {

/// Zero velocity and zero rotation between nodes i and j (9 values):
///
///   r = [ Log(R_i^T R_j) / rotation;  (p_j - p_i) / position;  v_j / velocity ]
///
/// Parameter blocks: pose_i 7, pose_j 7, motion_j 9.
class StandstillCost final : public ceres::SizedCostFunction<9, kPoseSize, kPoseSize, kMotionSize> {
 public:
  explicit StandstillCost(const StandstillNoise& noise);

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  StandstillNoise noise_;
};

}  // namespace parkade
