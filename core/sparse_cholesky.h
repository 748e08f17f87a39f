#pragma once

#include <Eigen/Core>
#include <Eigen/Sparse>

namespace parkade {

/// x of A x = b, one column for each of `b`.
///
/// A is symmetric and positive definite; only its lower triangle is read. Supernodal Cholesky (CHOLMOD), all of it in
/// the thread that calls: the result does not depend on how many there are. Throws Error{kInternal} where A is not
/// positive definite. Y. Chen, T. Davis, W. Hager, S. Rajamanickam, "Algorithm 887: CHOLMOD ...", ACM Trans. Math.
/// Softw. 35(3), 2008.
Eigen::MatrixXd SolveCholesky(const Eigen::SparseMatrix<double>& a, const Eigen::MatrixXd& b);

}  // namespace parkade
