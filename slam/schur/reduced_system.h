#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "slam/schur/reduced_matrix.h"

namespace parkade {

/// The normal equations of all states, landmarks eliminated: (A + D) x = b.
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
  std::unique_ptr<ReducedMatrix> matrix_;
  Eigen::VectorXd gradient_, right_, squared_norms_;
};

}  // namespace parkade
