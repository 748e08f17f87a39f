#pragma once

#include <ceres/cost_function.h>

#include <Eigen/Core>
#include <array>
#include <compare>
#include <cstdint>
#include <vector>

#include "slam/factors/camera_parameters.h"
#include "slam/factors/node_parameters.h"

namespace parkade {

/// Names a state of the smoother. In the order of a system's columns: nodes by
/// number, pose first; then the wheel scale; then cameras by index.
struct StateName {
  enum class Kind { kPose, kMotion, kWheelScale, kExtrinsics, kTiming };
  Kind kind = Kind::kPose;
  std::int64_t number = 0;  ///< of the node, or index of the camera; 0 for the wheel scale

  bool IsOfNode() const { return kind == Kind::kPose || kind == Kind::kMotion; }
  bool IsPose() const {
    return kind == Kind::kPose || kind == Kind::kExtrinsics;
  }  ///< lives on PoseManifold
  int Size() const;
  int TangentSize() const { return IsPose() ? kPoseTangentSize : Size(); }

  bool operator==(const StateName&) const = default;
  std::strong_ordering operator<=>(const StateName& other) const;
};

/// A state that a prior speaks about.
struct PriorBlock {
  StateName name;
  std::array<double, 9> at{};  ///< the values it was linearized at

  int Size() const { return name.Size(); }
  int TangentSize() const { return name.TangentSize(); }
  /// values [-] at, TangentSize() numbers.
  void Deviation(const double* values, double* deviation) const;
};

/// What marginalized states leave behind, in square-root form:
///   |offset + sqrt_information (x [-] at)|^2,
/// columns in the order of the blocks' tangents.
struct LinearPrior {
  std::vector<PriorBlock> blocks;
  Eigen::MatrixXd sqrt_information;
  Eigen::VectorXd offset;
  /// Covariance of sqrt_information^T offset, which would be the information if errors were as
  /// independent and as small as the weights have them: see ScoreElimination.
  Eigen::MatrixXd score_covariance;
  /// Derivative of that score by what is considered but not estimated, in units of its sigmas: see
  /// imu_sensitivity.h.
  Eigen::MatrixXd score_sensitivity;

  int Columns() const;
  /// First column of a state, which must be one of the blocks.
  int ColumnOf(const StateName& name) const;
  /// What the covariance of all its states would be if errors were as the weights have them: the
  /// inverse of the information, for an upper triangular sqrt_information. Directions that nothing
  /// is known about get a huge one.
  Eigen::MatrixXd ModelCovariance() const;
  /// The covariance of all its states, as large as their errors are ("sandwich").
  Eigen::MatrixXd Covariance() const;
};

/// What becomes of the scores' covariance when states are eliminated.
///
/// Least squares with weights that are not quite the noise's has errors e = -H^-1 s, where the
/// score s = J^T r sums the residuals at the truth: their covariance is H^-1 M H^-1 with M = Cov(s)
/// ("sandwich"). Eliminating states by
///   root (x_dropped) + to_kept (x_kept) + z = 0
/// leaves the rest with the score s_kept - to_kept^T z, z = root^-T s_dropped.
/// Constants that are considered but not estimated add B B^T to M, B = d score / d constant in
/// units of its sigma, kept apart as all factors share them. P. J. Huber, "The behavior of maximum
/// likelihood estimates under nonstandard conditions", 1967; S. F. Schmidt, "Application of
/// state-space methods to navigation problems", 1966.
struct ScoreElimination {
  Eigen::MatrixXd dropped;              ///< Cov(z); unity if the weights were right
  Eigen::MatrixXd cross;                ///< Cov(score of the kept, z); zero then
  Eigen::MatrixXd kept;                 ///< Cov(score of the kept); their information then
  Eigen::MatrixXd dropped_sensitivity;  ///< of z
  Eigen::MatrixXd kept_sensitivity;     ///< of the score of the kept
};

/// \param score_covariance, score_sensitivity  of all states, the dropped ones first
/// \param root                                 upper triangular, square
ScoreElimination EliminateScores(const Eigen::MatrixXd& score_covariance,
                                 const Eigen::MatrixXd& score_sensitivity,
                                 const Eigen::MatrixXd& root, const Eigen::MatrixXd& to_kept);

/// The prior as a cost of its blocks, in their order. Its Jacobian is constant:
/// that where states were condensed. `prior` is borrowed.
class LinearPriorCost final : public ceres::CostFunction {
 public:
  explicit LinearPriorCost(const LinearPrior* prior);
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  const LinearPrior* prior_;
};

}  // namespace parkade
