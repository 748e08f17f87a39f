#include "slam/factors/linearize_block.h"

#include <algorithm>
#include <cmath>

namespace parkade {

std::optional<LinearizedBlock> Linearize(const LinearizableBlock& block) {
  LinearizedBlock result;
  result.residual.resize(block.cost->num_residuals());
  std::vector<LinearizedBlock::Jacobian> full;
  std::vector<double*> pointers;
  for (const int size : block.cost->parameter_block_sizes())
    full.emplace_back(block.cost->num_residuals(), size);
  for (LinearizedBlock::Jacobian& jacobian : full) pointers.push_back(jacobian.data());
  if (!block.cost->Evaluate(block.parameters.data(), result.residual.data(), pointers.data()))
    return std::nullopt;
  double scale = 1;
  if (block.loss) {
    double rho[3];
    block.loss->Evaluate(result.residual.squaredNorm(), rho);
    scale = std::sqrt(rho[1]);
  }
  result.residual *= scale;
  for (size_t i = 0; i < full.size(); ++i)
    result.jacobians.push_back(scale * full[i].leftCols(block.tangent_sizes[i]));
  const auto is_finite = [](const LinearizedBlock::Jacobian& jacobian) {
    return jacobian.allFinite();
  };
  if (!result.residual.allFinite() ||
      !std::all_of(result.jacobians.begin(), result.jacobians.end(), is_finite))
    return std::nullopt;
  return result;
}

}  // namespace parkade
