#include "core/math/decompositions.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <cmath>

namespace parkade {

Eigen::Vector3d SolveSymmetric(const Eigen::Matrix3d& matrix, const Eigen::Vector3d& right) {
  return matrix.ldlt().solve(right);
}

Eigen::MatrixXd TriangularFactor(const Eigen::Ref<const Eigen::MatrixXd>& rows) {
  return Eigen::HouseholderQR<Eigen::MatrixXd>(rows).matrixQR().triangularView<Eigen::Upper>();
}

Eigen::Quaterniond RotationBetween(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  // As Eigen's FromTwoVectors, whose singular value decomposition for opposite directions takes the
  // compiler 12 s.
  const Eigen::Vector3d a = from.normalized(), b = to.normalized();
  const double cosine = b.dot(a);
  Eigen::Quaterniond rotation(0, 0, 0, 0);
  if (cosine < -1 + 1e-12) {
    rotation.vec() = a.unitOrthogonal();
    return rotation;
  }
  const double scale = std::sqrt((1 + cosine) * 2);
  rotation.vec() = a.cross(b) * (1 / scale);
  rotation.w() = scale * 0.5;
  return rotation;
}

Eigen::Quaterniond NearestRotation(const Eigen::Matrix3d& matrix) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sign = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  const Eigen::Matrix3d rotation =
      svd.matrixU() * Eigen::Vector3d(1, 1, sign).asDiagonal() * svd.matrixV().transpose();
  return Eigen::Quaterniond(rotation).normalized();
}

SymmetricEigen DecomposeSymmetric(const Eigen::Ref<const Eigen::MatrixXd>& matrix) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrix);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

Eigen::VectorXd SymmetricEigenvalues(const Eigen::Ref<const Eigen::MatrixXd>& matrix) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix, Eigen::EigenvaluesOnly)
      .eigenvalues();
}

Eigen::MatrixXd SquareRootOf(const Eigen::Ref<const Eigen::MatrixXd>& matrix) {
  const SymmetricEigen eigen = DecomposeSymmetric(matrix);
  return eigen.values.cwiseMax(0).cwiseSqrt().asDiagonal() * eigen.vectors.transpose();
}

}  // namespace parkade
