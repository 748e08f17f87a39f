#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "slam/schur/schur_chunk.h"

namespace parkade {

/// J^T J of all states, landmarks eliminated.
class ReducedMatrix {
 public:
  virtual ~ReducedMatrix() = default;
  virtual void SetZero() = 0;
  virtual void Add(size_t chunk, const SchurSums& sums) = 0;
  /// x of (A + D) x = b; nothing where A + D is not positive definite. The matrix is not A then.
  virtual std::optional<Eigen::VectorXd> Solve(const Eigen::VectorXd& damping,
                                               const Eigen::VectorXd& right) = 0;
};

/// Dense for a window's states, sparse for a drive's. `structure` is borrowed.
std::unique_ptr<ReducedMatrix> MakeReducedMatrix(const SchurStructure& structure);

/// The two, whatever the size.
std::unique_ptr<ReducedMatrix> MakeDenseMatrix(const SchurStructure& structure);
std::unique_ptr<ReducedMatrix> MakeSparseMatrix(const SchurStructure& structure);

}  // namespace parkade
