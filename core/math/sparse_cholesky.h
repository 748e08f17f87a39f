#pragma once

#include <Eigen/Core>
#include <Eigen/Sparse>
#include <memory>
#include <span>

namespace parkade {

/// Solves A x = b; x has one column for each of `b`.
///
/// A is symmetric and positive definite; only its lower triangle is read. Supernodal Cholesky
/// (CHOLMOD), all of it in the thread that calls: the result does not depend on how many there are.
/// Throws Error{kInternal} where A is not positive definite. Y. Chen, T. Davis, W. Hager, S.
/// Rajamanickam, "Algorithm 887: CHOLMOD ...", ACM Trans. Math. Softw. 35(3), 2008.
Eigen::MatrixXd SolveCholesky(const Eigen::SparseMatrix<double>& a, const Eigen::MatrixXd& b);

/// The same for matrices whose entries are at the same places, one after the other: the order in
/// which they are eliminated is found once.
class CholeskySolver {
 public:
  CholeskySolver();
  ~CholeskySolver();
  CholeskySolver(const CholeskySolver&) = delete;
  CholeskySolver& operator=(const CholeskySolver&) = delete;

  /// Keeps no numbers.
  Eigen::MatrixXd Solve(const Eigen::SparseMatrix<double>& a, const Eigen::MatrixXd& b);

  /// The same to about a hundredth of x's energy norm, as a step of a minimization needs it, in
  /// less time where A is similar to the last one: by conjugate gradients, which that one's factor
  /// preconditions, until x^T A x hardly grows. Keeps the factor. M. Hestenes, E. Stiefel, "Methods
  /// of conjugate gradients for solving linear systems", 1952.
  Eigen::VectorXd SolveSimilar(const Eigen::SparseMatrix<double>& a, const Eigen::VectorXd& b);

  /// The columns of A^-1 with these numbers, side by side. Keeps no numbers, and takes less memory
  /// than to solve for as many columns.
  Eigen::MatrixXd InverseColumns(const Eigen::SparseMatrix<double>& a,
                                 std::span<const int> columns);

 private:
  class Factor;
  std::unique_ptr<Factor> factor_;
};

}  // namespace parkade
