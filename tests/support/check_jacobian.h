#pragma once

#include <ceres/cost_function.h>
#include <ceres/manifold.h>

#include <Eigen/Core>
#include <functional>
#include <vector>

namespace parkade {

/// Largest difference between analytic and numeric Jacobian of a block, both by
/// the block's tangent, relative to 1 + the largest entry.
///
/// \param manifolds  one per block; null: Euclidean
/// \param changed    called after parameters changed, before each evaluation
inline double JacobianError(
    const ceres::CostFunction& cost, std::vector<std::vector<double>>& parameters,
    const std::vector<const ceres::Manifold*>& manifolds,
    const std::function<void()>& changed = [] {}) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const auto& sizes = cost.parameter_block_sizes();
  std::vector<const double*> values;
  for (const auto& block : parameters) values.push_back(block.data());
  std::vector<RowMajor> jacobians;
  std::vector<double*> pointers;
  for (const int size : sizes) jacobians.emplace_back(cost.num_residuals(), size);
  for (RowMajor& jacobian : jacobians) pointers.push_back(jacobian.data());
  Eigen::VectorXd residual(cost.num_residuals());
  changed();
  if (!cost.Evaluate(values.data(), residual.data(), pointers.data())) return 1e9;

  double worst = 0;
  for (size_t block = 0; block < sizes.size(); ++block) {
    const ceres::Manifold* manifold = manifolds[block];
    const int tangent = manifold ? manifold->TangentSize() : sizes[block];
    RowMajor lift = RowMajor::Identity(sizes[block], tangent);
    if (manifold) manifold->PlusJacobian(values[block], lift.data());
    const Eigen::MatrixXd analytic = jacobians[block] * lift;
    const std::vector<double> original = parameters[block];
    for (int column = 0; column < tangent; ++column) {
      constexpr double kStep = 1e-6;
      Eigen::VectorXd sides[2];
      for (const int side : {0, 1}) {
        Eigen::VectorXd delta = Eigen::VectorXd::Zero(tangent);
        delta[column] = side == 0 ? -kStep : kStep;
        if (manifold)
          manifold->Plus(original.data(), delta.data(), parameters[block].data());
        else
          parameters[block][static_cast<size_t>(column)] =
              original[static_cast<size_t>(column)] + delta[column];
        changed();
        sides[side].resize(cost.num_residuals());
        if (!cost.Evaluate(values.data(), sides[side].data(), nullptr)) return 1e9;
        std::copy(original.begin(), original.end(), parameters[block].begin());
      }
      const Eigen::VectorXd numeric = (sides[1] - sides[0]) / (2 * kStep);
      worst = std::max(worst, (numeric - analytic.col(column)).cwiseAbs().maxCoeff() /
                                  (1 + analytic.cwiseAbs().maxCoeff()));
    }
  }
  changed();
  return worst;
}

}  // namespace parkade
