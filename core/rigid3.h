#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace parkade {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

/// A rigid motion, always named `target_from_source`:
/// `x_in_target = target_from_source * x_in_source`. Neighbors cancel.
struct Rigid3 {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();  ///< [m]

  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const {
    return rotation * point + translation;
  }

  Rigid3 operator*(const Rigid3& other) const {
    return {(rotation * other.rotation).normalized(), rotation * other.translation + translation};
  }

  Rigid3 Inverse() const {
    const Eigen::Quaterniond inverse = rotation.conjugate();
    return {inverse, -(inverse * translation)};
  }

  /// 4 x 4 homogeneous.
  Eigen::Matrix4d Matrix() const;

  /// Nearest rigid motion of a 4 x 4 homogeneous matrix. Throws
  /// Error{kInvalidInput} when the matrix is not one (rotation off by > 1e-3).
  static Rigid3 FromMatrix(const Eigen::Matrix4d& matrix);
};

/// [w]x, so that Skew(a) * b = a x b.
Eigen::Matrix3d Skew(const Eigen::Vector3d& w);

/// Rotation vector [rad] to quaternion, exact at and near zero.
Eigen::Quaterniond ExpSo3(const Eigen::Vector3d& rotation_vector);

/// Quaternion to rotation vector [rad] of norm <= pi.
Eigen::Vector3d LogSo3(const Eigen::Quaterniond& rotation);

/// Right Jacobian of SO(3): Exp(w + dw) ~ Exp(w) Exp(Jr(w) dw).
/// C. Forster et al., "On-Manifold Preintegration", TRO 2017, eq. 8.
Eigen::Matrix3d RightJacobianSo3(const Eigen::Vector3d& rotation_vector);
Eigen::Matrix3d InverseRightJacobianSo3(const Eigen::Vector3d& rotation_vector);

/// Geodesic in rotation, straight line in translation; `fraction` in [0, 1].
Rigid3 Interpolate(const Rigid3& from, const Rigid3& to, double fraction);

}  // namespace parkade
