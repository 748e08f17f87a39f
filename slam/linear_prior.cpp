#include "slam/linear_prior.h"

namespace parkade {

int LinearPrior::Columns() const {
  int columns = 0;
  for (const PriorBlock& block : blocks) columns += block.TangentSize();
  return columns;
}

LinearPriorCost::LinearPriorCost(const LinearPrior* prior) : prior_(prior) {
  set_num_residuals(static_cast<int>(prior->sqrt_information.rows()));
  for (const PriorBlock& block : prior->blocks) mutable_parameter_block_sizes()->push_back(block.Size());
}

bool LinearPriorCost::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  Eigen::VectorXd change(prior_->sqrt_information.cols());
  int column = 0;
  for (size_t i = 0; i < prior_->blocks.size(); ++i) {
    const PriorBlock& block = prior_->blocks[i];
    if (block.kind == PriorBlock::Kind::kPose) {
      PoseManifold().Minus(parameters[i], block.at.data(), change.data() + column);
    } else {
      for (int k = 0; k < block.Size(); ++k) change[column + k] = parameters[i][k] - block.at[static_cast<size_t>(k)];
    }
    if (jacobians && jacobians[i]) {
      Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> jacobian(
          jacobians[i], num_residuals(), block.Size());
      jacobian.leftCols(block.TangentSize()) = prior_->sqrt_information.middleCols(column, block.TangentSize());
      if (block.TangentSize() < block.Size()) jacobian.rightCols<1>().setZero();
    }
    column += block.TangentSize();
  }
  Eigen::Map<Eigen::VectorXd> residual(residuals, num_residuals());
  residual = prior_->offset;
  residual.noalias() += prior_->sqrt_information * change;
  return true;
}

}  // namespace parkade
