#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace parkade {

// Decompositions that several folders need. Each is compiled once: of all templates they take a
// compiler longest.

/// x of `matrix` x = `right`, for a positive semidefinite matrix, by LDL^T; not finite where the
/// matrix is singular.
Eigen::Vector3d SolveSymmetric(const Eigen::Matrix3d& matrix, const Eigen::Vector3d& right);

/// R of `rows` = Q R with an orthogonal Q, by Householder's reflections; as tall as `rows`.
Eigen::MatrixXd TriangularFactor(const Eigen::Ref<const Eigen::MatrixXd>& rows);

/// The smallest rotation that takes the direction of `from` to the direction of `to`.
Eigen::Quaterniond RotationBetween(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

/// The rotation nearest to `matrix` by the Frobenius norm.
/// W. Kabsch, "A solution for the best rotation to relate two sets of vectors", 1976.
Eigen::Quaterniond NearestRotation(const Eigen::Matrix3d& matrix);

/// matrix = vectors diag(values) vectors^T.
struct SymmetricEigen {
  Eigen::VectorXd values;   ///< ascending
  Eigen::MatrixXd vectors;  ///< n x n, one per column
};

/// The eigenvalues and eigenvectors of a symmetric matrix, whose lower triangle is read.
SymmetricEigen DecomposeSymmetric(const Eigen::Ref<const Eigen::MatrixXd>& matrix);

/// Its eigenvalues alone, ascending.
Eigen::VectorXd SymmetricEigenvalues(const Eigen::Ref<const Eigen::MatrixXd>& matrix);

/// S with S^T S = `matrix`, which is symmetric; negative eigenvalues count as 0.
Eigen::MatrixXd SquareRootOf(const Eigen::Ref<const Eigen::MatrixXd>& matrix);

}  // namespace parkade
