#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "slam/schur/schur_kernels.h"

namespace parkade {

/// A symmetric matrix of a few hundred rows, each of which is zero before a given column. What is
/// left of it then stays zero in the Cholesky factor, too: A. Jennings, "A compact storage scheme
/// for the solution of symmetric linear simultaneous equations", The Computer Journal, 1966.
class EnvelopeMatrix {
 public:
  /// \param first_columns  of each row, at most its own
  explicit EnvelopeMatrix(std::vector<int> first_columns);

  int size() const { return static_cast<int>(first_columns_.size()) - 1; }
  /// Lower triangle: columns from the first to the row's own.
  double* Row(int row) { return values_.data() + row * stride_; }
  const double* Row(int row) const { return values_.data() + row * stride_; }
  void SetZero();

  /// x of A x = b, in place of which the matrix holds its factor; nothing where A is not positive
  /// definite. Cubic in the size.
  std::optional<Eigen::VectorXd> Solve(const Eigen::VectorXd& b);

 private:
  /// False where a pivot is not positive.
  bool FactorDiagonal(int begin, int count);
  void FindRows(int begin, int count);
  void DivideRows(int begin, int count);

  std::ptrdiff_t stride_ = 0;
  std::vector<int> first_columns_;        // in whole vectors; of the right side, too
  std::vector<int> first_of_vectors_;     // the first of as many rows
  std::vector<double> values_;            // row by row; the right side is the last
  std::vector<double> panel_;             // some columns below the diagonal, one after the other
  std::vector<int> rows_;                 // that these columns reach
  std::vector<ColumnRange> row_vectors_;  // the same, in whole vectors
};

}  // namespace parkade
