#pragma once

#include <ceres/cost_function.h>

#include <Eigen/Core>

#include "slam/factors/relative_pose_cost.h"
#include "slam/refinement/covariance_modes.h"

namespace parkade {

inline constexpr int kFrameSize = 4;  ///< of a drive in its site: yaw [rad], translation [m]

Rigid3 FrameFromParameters(const double* frame);

/// A pose of a drive in the site, moved by the drive's frame there and by its modes: kFrameSize
/// parameters and one per mode.
struct PerturbedPose {
  Rigid3 odom_from_pose;  ///< with all modes zero
  Eigen::MatrixXd modes;  ///< 6 x modes, CovarianceModes::At

  Rigid3 InSite(const double* frame, const double* bends) const;
};

/// A measured relative pose between two drives: RelativePoseError, weighted, of where PerturbedPose
/// puts them. Parameter blocks: frame and bends of the one drive, frame and bends of the other.
class SessionLoopCost final : public ceres::CostFunction {
 public:
  /// \param square_root_weight  S with S^T S = information of RelativePoseError
  SessionLoopCost(PerturbedPose from, PerturbedPose to, const Rigid3& from_from_to,
                  const Matrix6d& square_root_weight);
  bool Evaluate(double const* const* parameters, double* residual,
                double** jacobians) const override;

 private:
  PerturbedPose from_, to_;
  RelativePoseCost cost_;
};

}  // namespace parkade
