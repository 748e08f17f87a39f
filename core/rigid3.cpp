#include "core/rigid3.h"

#include <Eigen/SVD>
#include <cmath>

#include "core/error.h"

namespace parkade {
namespace {

// Below this angle [rad] the series is exact to double precision.
constexpr double kSmallAngle = 1e-4;

}  // namespace

Eigen::Matrix4d Rigid3::Matrix() const {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = rotation.toRotationMatrix();
  matrix.topRightCorner<3, 1>() = translation;
  return matrix;
}

Rigid3 Rigid3::FromMatrix(const Eigen::Matrix4d& matrix) {
  const Eigen::Matrix3d given = matrix.topLeftCorner<3, 3>();
  Require(matrix.allFinite(), ErrorCode::kInvalidInput,
          "a 4x4 transform holds a number that is not finite");
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(given, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d nearest = svd.matrixU() * svd.matrixV().transpose();
  const bool is_rigid = (nearest - given).norm() < 1e-3 && nearest.determinant() > 0 &&
                        (matrix.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).norm() < 1e-9;
  Require(is_rigid, ErrorCode::kInvalidInput, "a 4x4 transform is not a rigid motion");
  return {Eigen::Quaterniond(nearest).normalized(), matrix.topRightCorner<3, 1>()};
}

Eigen::Matrix3d Skew(const Eigen::Vector3d& w) {
  Eigen::Matrix3d skew;
  skew << 0, -w.z(), w.y(), w.z(), 0, -w.x(), -w.y(), w.x(), 0;
  return skew;
}

Eigen::Quaterniond ExpSo3(const Eigen::Vector3d& rotation_vector) {
  const double angle = rotation_vector.norm();
  // sin(a/2)/a
  const double scale = angle < kSmallAngle ? 0.5 - angle * angle / 48 : std::sin(angle / 2) / angle;
  Eigen::Quaterniond rotation;
  rotation.w() = std::cos(angle / 2);
  rotation.vec() = scale * rotation_vector;
  return rotation.normalized();
}

Eigen::Vector3d LogSo3(const Eigen::Quaterniond& rotation) {
  const double sign = rotation.w() < 0 ? -1.0 : 1.0;
  const double w = sign * rotation.w();
  const Eigen::Vector3d vec = sign * rotation.vec();
  const double sine = vec.norm();
  const double scale =
      sine < kSmallAngle ? 2 / w * (1 - sine * sine / (3 * w * w)) : 2 * std::atan2(sine, w) / sine;
  return scale * vec;
}

Eigen::Matrix3d RightJacobianSo3(const Eigen::Vector3d& rotation_vector) {
  const double angle = rotation_vector.norm();
  const Eigen::Matrix3d skew = Skew(rotation_vector);
  const double a2 = angle * angle;
  if (angle < kSmallAngle) return Eigen::Matrix3d::Identity() - 0.5 * skew + skew * skew / 6;
  return Eigen::Matrix3d::Identity() - (1 - std::cos(angle)) / a2 * skew +
         (angle - std::sin(angle)) / (a2 * angle) * skew * skew;
}

Eigen::Matrix3d InverseRightJacobianSo3(const Eigen::Vector3d& rotation_vector) {
  const double angle = rotation_vector.norm();
  const Eigen::Matrix3d skew = Skew(rotation_vector);
  if (angle < kSmallAngle) return Eigen::Matrix3d::Identity() + 0.5 * skew + skew * skew / 12;
  const double half = 0.5 * angle;
  return Eigen::Matrix3d::Identity() + 0.5 * skew +
         (1 - half * std::cos(half) / std::sin(half)) / (angle * angle) * skew * skew;
}

Rigid3 Interpolate(const Rigid3& from, const Rigid3& to, double fraction) {
  const Eigen::Vector3d turn = LogSo3(from.rotation.conjugate() * to.rotation);
  return {(from.rotation * ExpSo3(fraction * turn)).normalized(),
          from.translation + fraction * (to.translation - from.translation)};
}

}  // namespace parkade
