#pragma once

#include <ceres/cost_function.h>

#include <Eigen/Core>
#include <array>
#include <compare>
#include <cstdint>
#include <vector>

#include "slam/camera_parameters.h"
#include "slam/knot_parameters.h"

namespace parkade {

/// Names a state of the smoother. In the order of a system's columns: knots by
/// number, pose first; then the wheel scale; then cameras by index.
struct StateName {
  enum class Kind { kPose, kMotion, kWheelScale, kExtrinsics, kTiming };
  Kind kind = Kind::kPose;
  std::int64_t number = 0;  ///< of the knot, or index of the camera; 0 for the wheel scale

  bool IsOfKnot() const { return kind == Kind::kPose || kind == Kind::kMotion; }
  bool IsPose() const { return kind == Kind::kPose || kind == Kind::kExtrinsics; }  ///< lives on PoseManifold
  int Size() const;
  int TangentSize() const { return IsPose() ? kPoseTangentSize : Size(); }

  bool operator==(const StateName&) const = default;
  std::strong_ordering operator<=>(const StateName& other) const;
};

/// A state that a prior speaks about.
struct PriorBlock {
  StateName name;
  std::array<double, 9> at{};  ///< the values it was linearised at

  int Size() const { return name.Size(); }
  int TangentSize() const { return name.TangentSize(); }
  /// values [-] at, TangentSize() numbers.
  void Deviation(const double* values, double* deviation) const;
};

/// What marginalised states leave behind, in square-root form:
///   |offset + sqrt_information (x [-] at)|^2,
/// columns in the order of the blocks' tangents.
struct LinearPrior {
  std::vector<PriorBlock> blocks;
  Eigen::MatrixXd sqrt_information;
  Eigen::VectorXd offset;

  int Columns() const;
  /// First column of a state, which must be one of the blocks.
  int ColumnOf(const StateName& name) const;
  /// Of all its states; upper triangular sqrt_information. Directions that nothing is known about get a huge one.
  Eigen::MatrixXd Covariance() const;
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
