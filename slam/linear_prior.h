#pragma once

#include <ceres/cost_function.h>

#include <Eigen/Core>
#include <array>
#include <vector>

#include "slam/knot_parameters.h"

namespace parkade {

/// A state that a prior speaks about.
struct PriorBlock {
  enum class Kind { kPose, kMotion, kWheelScale };
  Kind kind = Kind::kPose;
  std::int64_t knot = -1;      ///< its number; -1 for the wheel scale
  std::array<double, 9> at{};  ///< the values it was linearised at

  int Size() const { return kind == Kind::kPose ? kPoseSize : kind == Kind::kMotion ? kMotionSize : 1; }
  int TangentSize() const { return kind == Kind::kPose ? kPoseTangentSize : kind == Kind::kMotion ? kMotionSize : 1; }
};

/// What marginalised states leave behind, in square-root form:
///   |offset + sqrt_information (x [-] at)|^2,
/// columns in the order of the blocks' tangents.
struct LinearPrior {
  std::vector<PriorBlock> blocks;
  Eigen::MatrixXd sqrt_information;
  Eigen::VectorXd offset;

  int Columns() const;
};

/// The prior as a cost of its blocks, in their order. Its Jacobian is constant:
/// that of the first estimate. `prior` is borrowed.
class LinearPriorCost final : public ceres::CostFunction {
 public:
  explicit LinearPriorCost(const LinearPrior* prior);
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  const LinearPrior* prior_;
};

}  // namespace parkade
