#pragma once

#include <ceres/cost_function.h>
#include <ceres/loss_function.h>

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace parkade {

/// A residual block with the parameters to linearize it at. `columns` holds, per
/// parameter block, the first column of its tangent in the system; the tangent
/// is the first `tangent_sizes` columns of the block's Jacobian (identity lift).
struct LinearizableBlock {
  const ceres::CostFunction* cost = nullptr;
  const ceres::LossFunction* loss = nullptr;  ///< null: none
  std::vector<const double*> parameters;
  std::vector<int> columns;
  std::vector<int> tangent_sizes;
};

struct LinearizedBlock {
  using Jacobian = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  std::vector<Jacobian> jacobians;  ///< by the blocks' tangents
  Eigen::VectorXd residual;
};

/// Residual and Jacobians, both scaled by the root of the loss' slope: the Gauss-Newton part of
/// Triggs' correction, which keeps the system definite. Nothing where the block cannot be
/// evaluated.
std::optional<LinearizedBlock> Linearize(const LinearizableBlock& block);

}  // namespace parkade
