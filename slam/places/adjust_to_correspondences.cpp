#include "slam/places/adjust_to_correspondences.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <map>

namespace parkade {
namespace {

constexpr int kSteps = 8;
constexpr double kLeastScatter =
    0.25;  // of squared residuals in units of their variances, at least
constexpr double kFloorTranslation = 0.007;           // [m] below which no loop is believed
constexpr double kFloorRotation = 0.04 * M_PI / 180;  // [rad] below which no loop is believed

double WeightOf(const CorrespondenceError& error) {
  return 1 / (1 + error.whitened.squaredNorm() / 4);
}

}  // namespace

Matrix6d AdjustToCorrespondences(const std::vector<RayPointCorrespondence>& correspondences,
                                 double tilt_sigma, Rigid3& a_from_b) {
  Matrix6d hessian;
  for (int step = 0; step < kSteps; ++step) {
    hessian.setZero();
    Vector6d gradient = Vector6d::Zero();
    for (const RayPointCorrespondence& correspondence : correspondences) {
      const CorrespondenceError error = ErrorOf(correspondence, a_from_b);
      const double weight = WeightOf(error);
      hessian += weight * error.jacobian.transpose() * error.jacobian;
      gradient += weight * error.jacobian.transpose() * error.whitened;
    }
    if (tilt_sigma > 0) {
      // Both keyframes are level: what tilts one against the other costs.
      const double weight = 1 / (tilt_sigma * tilt_sigma);
      const Eigen::Vector3d up_in_b = a_from_b.rotation.conjugate() * Eigen::Vector3d::UnitZ();
      const Eigen::Vector3d tilt_error = Eigen::Vector3d::UnitZ().cross(up_in_b);
      const Eigen::Matrix3d by_turn = Skew(Eigen::Vector3d::UnitZ()) * Skew(up_in_b);
      hessian.bottomRightCorner<3, 3>() += weight * by_turn.transpose() * by_turn;
      gradient.tail<3>() += weight * by_turn.transpose() * tilt_error;
    }
    const Vector6d delta = -(hessian + 1e-9 * Matrix6d::Identity()).ldlt().solve(gradient);
    a_from_b.translation += a_from_b.rotation * delta.head<3>();
    a_from_b.rotation = (a_from_b.rotation * ExpSo3(delta.tail<3>())).normalized();
    if (delta.norm() < 1e-7) break;
  }
  return hessian;
}

Matrix6d CovarianceOfCorrespondences(const std::vector<RayPointCorrespondence>& correspondences,
                                     const Matrix6d& hessian, const Rigid3& a_from_b,
                                     const RelativePoseOptions& options) {
  std::map<int, Matrix6d> score_by_mount;  // per camera: J^T W G
  double sum = 0;
  for (const RayPointCorrespondence& correspondence : correspondences) {
    const CorrespondenceError error = ErrorOf(correspondence, a_from_b);
    const MountJacobians by_mount = MountJacobiansOf(correspondence, a_from_b);
    const Eigen::Matrix<double, 6, 2> score = WeightOf(error) * error.jacobian.transpose();
    score_by_mount.try_emplace(by_mount.ray_camera, Matrix6d::Zero()).first->second +=
        score * by_mount.by_ray;
    score_by_mount.try_emplace(by_mount.point_camera, Matrix6d::Zero()).first->second +=
        score * by_mount.by_point;
    sum += error.whitened.squaredNorm();
  }
  const Matrix6d inverse =
      (hessian + 1e-9 * Matrix6d::Identity()).ldlt().solve(Matrix6d::Identity());
  const double num_numbers = 2.0 * static_cast<double>(correspondences.size());
  const double scatter = num_numbers > 6 ? std::max(kLeastScatter, sum / (num_numbers - 6)) : 1;
  Vector6d mount;
  mount << Eigen::Vector3d::Constant(options.mount_translation),
      Eigen::Vector3d::Constant(options.mount_rotation_deg * M_PI / 180);
  Matrix6d covariance = scatter * inverse;
  for (const auto& [camera, score] : score_by_mount) {
    const Matrix6d moved = inverse * score * mount.asDiagonal();
    covariance += moved * moved.transpose();
  }
  return covariance;
}

void SetInformation(const Matrix6d& covariance_of_correspondences, RelativePose& pose) {
  Matrix6d covariance = covariance_of_correspondences;
  covariance.diagonal().head<3>().array() += kFloorTranslation * kFloorTranslation;
  covariance.diagonal().tail<3>().array() += kFloorRotation * kFloorRotation;
  const Eigen::Matrix3d translation = covariance.topLeftCorner<3, 3>();
  pose.worst_sigma =
      std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(translation, Eigen::EigenvaluesOnly)
                    .eigenvalues()
                    .maxCoeff());
  pose.information = covariance.ldlt().solve(Matrix6d::Identity());
  pose.information = 0.5 * (pose.information + pose.information.transpose()).eval();
}

}  // namespace parkade
