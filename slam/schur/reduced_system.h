#pragma once

#include <Eigen/Sparse>
#include <optional>
#include <vector>

#include "core/sparse_cholesky.h"
#include "slam/schur/schur_chunk.h"

namespace parkade {

/// The normal equations of all states, landmarks eliminated: (A + D) x = b, A sparse.
class ReducedSystem {
 public:
  explicit ReducedSystem(const SchurStructure& structure);

  void SetZero();
  void Add(size_t chunk, const SchurSums& sums);
  /// x; nothing where A + D is not positive definite.
  std::optional<Eigen::VectorXd> Solve(const Eigen::VectorXd& damping);

  const Eigen::VectorXd& squared_norms() const { return squared_norms_; }  ///< of columns of J
  const Eigen::VectorXd& gradient() const { return gradient_; }            ///< J^T r

 private:
  const SchurStructure& structure_;
  Eigen::SparseMatrix<double> matrix_;  ///< lower triangle, with whole blocks on the diagonal
  std::vector<std::vector<Eigen::Index>>
      offsets_;  ///< into its values: of blocks, by chunk and pair
  Eigen::VectorXd gradient_, right_, squared_norms_;
  CholeskySolver solver_;
};

}  // namespace parkade
