#pragma once

#include <Eigen/Core>
#include <Eigen/Sparse>
#include <memory>

namespace parkade {

/// Solves A x = b; x has one column for each of `b`.
///
/// A is symmetric and positive definite; only its lower triangle is read. Supernodal Cholesky
/// (CHOLMOD), all of it in the thread that calls: the result does not depend on how many there are.
/// Throws Error{kInternal} where A is not positive definite. Y. Chen, T. Davis, W. Hager, S.
/// Rajamanickam, "Algorithm 887: CHOLMOD ...", ACM Trans. Math. Softw. 35(3), 2008.
Eigen::MatrixXd SolveCholesky(const Eigen::SparseMatrix<double>& a, const Eigen::MatrixXd& b);

/// The same for matrices whose entries are at the same places, one after the other: the order in
/// which they are eliminated is found once. Between them it keeps no numbers.
class CholeskySolver {
 public:
  CholeskySolver();
  ~CholeskySolver();
  CholeskySolver(const CholeskySolver&) = delete;
  CholeskySolver& operator=(const CholeskySolver&) = delete;

  Eigen::MatrixXd Solve(const Eigen::SparseMatrix<double>& a, const Eigen::MatrixXd& b);

 private:
  class Factor;
  std::unique_ptr<Factor> factor_;
};

}  // namespace parkade
