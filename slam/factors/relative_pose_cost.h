#pragma once

#include <ceres/manifold.h>
#include <ceres/sized_cost_function.h>

#include "core/rigid3.h"
#include "slam/factors/node_parameters.h"

namespace parkade {

/// S * RelativePoseError of one edge. Parameter blocks: the poses of `from` and
/// `to` as in node_parameters.h (7 each, Jacobians by the tangent).
///
/// With error rotation (w, v) = measured^-1 from^-1 to and d a turn on the right of a pose,
///   d(2v)/d(to) = w I + [v]x,   d(2v)/d(from) = -(w I - [v]x) R^T,   R = measured rotation,
/// and with x = R_from^T (t_to - t_from) the translation part is R^T (x - t), hence
///   d/d(turn of from) = R^T [x]x,   d/d(t_to) = -d/d(t_from) = (R_from R)^T.
class RelativePoseCost final : public ceres::SizedCostFunction<6, kPoseSize, kPoseSize> {
 public:
  RelativePoseCost(const Rigid3& from_from_to, const Matrix6d& square_root_weight)
      : from_from_to_(from_from_to), square_root_weight_(square_root_weight) {}

  bool Evaluate(const double* const* parameters, double* residual,
                double** jacobians) const override;

 private:
  const Rigid3 from_from_to_;
  const Matrix6d square_root_weight_;
};

/// A pose that keeps z, roll and pitch; tangent 3: [yaw | x | y].
class PlanarPoseManifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return kPoseSize; }
  int TangentSize() const override { return 3; }
  bool Plus(const double* pose, const double* delta, double* pose_plus_delta) const override;
  bool PlusJacobian(const double* pose, double* jacobian) const override;
  bool Minus(const double* pose_plus_delta, const double* pose, double* delta) const override;
  bool MinusJacobian(const double* pose, double* jacobian) const override;
};

}  // namespace parkade
