#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>

#include "core/math/dual.h"

namespace parkade {

// One struct per lens. Each has
//   Project    pixel of a point [m] in the camera frame (z forward, x right, y down), or false
//              outside the model's domain: behind the lens, or where the model folds and two points
//              would share a pixel. T is double, Dual or ceres::Jet. The length of the point does
//              not matter.
//   Unproject  unit bearing of a pixel, or nothing outside the domain; exact inverse of Project.
//   Validate   throws Error{kInvalidInput} naming the parameter that is out of its range.
//   Scaled     the same lens on an image resized by a factor (pixel centers at integers).
// Members called max_* are the domain's limits. They follow from the parameters above them: to
// change a parameter make a new value, e.g. KannalaBrandtProjection{.fx = 400, .fy = 400, .cx =
// 640, .cy = 480, .k1 = 0.01}.

/// Distortion of the normalized image plane by J.-Y. Bouguet / OpenCV ("radtan").
struct RadTanDistortion {
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0;
  double max_radius_squared = FindMaxRadiusSquared(k1, k2, p1, p2, k3);

  template <typename T>
  bool Distort(const T& x, const T& y, T* distorted_x, T* distorted_y) const {
    const T r2 = x * x + y * y;
    if (!(ValueOf(r2) <= max_radius_squared)) return false;
    const T radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
    const T xy = x * y;
    *distorted_x = x * radial + 2 * p1 * xy + p2 * (r2 + 2.0 * (x * x));
    *distorted_y = y * radial + p1 * (r2 + 2.0 * (y * y)) + 2 * p2 * xy;
    return true;
  }

  std::optional<Eigen::Vector2d> Undistort(const Eigen::Vector2d& distorted) const;
  void Validate() const;

  /// Largest radius up to which distortion is one-to-one.
  static double FindMaxRadiusSquared(double k1, double k2, double p1, double p2, double k3);
};

struct PinholeProjection {
  double fx = 1, fy = 1, cx = 0, cy = 0;  ///< [px]

  template <typename T>
  bool Project(const Eigen::Matrix<T, 3, 1>& point, Eigen::Matrix<T, 2, 1>* pixel) const {
    if (!IsInFrontOfPlane(ValueOf(point.x()), ValueOf(point.y()), ValueOf(point.z()))) return false;
    const T inverse_z = 1.0 / point.z();
    *pixel << fx * (point.x() * inverse_z) + cx, fy * (point.y() * inverse_z) + cy;
    return true;
  }

  std::optional<Eigen::Vector3d> Unproject(const Eigen::Vector2d& pixel) const;
  void Validate() const;
  PinholeProjection Scaled(double factor) const;

  /// Leaves out the last 1e-6 rad before the plane z = 0, where pixels go to infinity.
  static bool IsInFrontOfPlane(double x, double y, double z) {
    return z > 1e-6 * (std::abs(x) + std::abs(y));
  }
};

/// Pinhole with RadTanDistortion, as cv::projectPoints.
struct RadTanProjection {
  double fx = 1, fy = 1, cx = 0, cy = 0;  ///< [px]
  RadTanDistortion distortion = {};

  template <typename T>
  bool Project(const Eigen::Matrix<T, 3, 1>& point, Eigen::Matrix<T, 2, 1>* pixel) const {
    if (!PinholeProjection::IsInFrontOfPlane(ValueOf(point.x()), ValueOf(point.y()),
                                             ValueOf(point.z())))
      return false;
    const T inverse_z = 1.0 / point.z();
    T x, y;
    if (!distortion.Distort<T>(point.x() * inverse_z, point.y() * inverse_z, &x, &y)) return false;
    *pixel << fx * x + cx, fy * y + cy;
    return true;
  }

  std::optional<Eigen::Vector3d> Unproject(const Eigen::Vector2d& pixel) const;
  void Validate() const;
  RadTanProjection Scaled(double factor) const;
};

/// Pinhole with "equidistant" distortion, as cv::fisheye: r = t + k1 t^3 + ... + k4 t^9 of the
/// angle t to the axis, up to t = pi or where r stops growing. J. Kannala, S. Brandt, "A Generic
/// Camera Model and Calibration Method", TPAMI 2006, eq. 6.
struct KannalaBrandtProjection {
  double fx = 1, fy = 1, cx = 0, cy = 0;  ///< [px]
  double k1 = 0, k2 = 0, k3 = 0, k4 = 0;
  double max_theta = FindMaxTheta(k1, k2, k3, k4);  ///< [rad] to the axis

  template <typename T>
  bool Project(const Eigen::Matrix<T, 3, 1>& point, Eigen::Matrix<T, 2, 1>* pixel) const {
    using std::atan2;
    using std::sqrt;
    const T& z = point.z();
    const T r2 = point.x() * point.x() + point.y() * point.y();
    T radius_per_meter;  // of the normalized image per distance to the axis
    if (ValueOf(r2) < 1e-12 * ValueOf(z) * ValueOf(z)) {
      // On the axis sqrt has no derivative: series in tan^2 instead.
      if (!(ValueOf(z) > 0)) return false;
      radius_per_meter = (1.0 + (k1 - 1.0 / 3.0) * (r2 / (z * z))) / z;
    } else {
      const T r = sqrt(r2);
      const T theta = atan2(r, z);
      if (!(ValueOf(theta) <= max_theta)) return false;
      const T t2 = theta * theta;
      radius_per_meter = theta * (1.0 + t2 * (k1 + t2 * (k2 + t2 * (k3 + t2 * k4)))) / r;
    }
    *pixel << fx * (point.x() * radius_per_meter) + cx, fy * (point.y() * radius_per_meter) + cy;
    return true;
  }

  std::optional<Eigen::Vector3d> Unproject(const Eigen::Vector2d& pixel) const;
  void Validate() const;
  KannalaBrandtProjection Scaled(double factor) const;

  static double FindMaxTheta(double k1, double k2, double k3, double k4);
};

/// Unified model with distortion (Kalibr's "omni", cv::omnidir with s = 0).
/// C. Mei, P. Rives, "Single View Point Omnidirectional Camera Calibration from Planar Grids", ICRA
/// 2007.
struct MeiProjection {
  double xi = 0;                          ///< >= 0
  double fx = 1, fy = 1, cx = 0, cy = 0;  ///< [px]
  RadTanDistortion distortion = {};

  template <typename T>
  bool Project(const Eigen::Matrix<T, 3, 1>& point, Eigen::Matrix<T, 2, 1>* pixel) const {
    using std::sqrt;
    const T norm = sqrt(point.x() * point.x() + point.y() * point.y() + point.z() * point.z());
    const T depth = point.z() + xi * norm;
    const double distance = ValueOf(norm);
    // The second condition is the fold of xi > 1; it always holds for xi <= 1.
    if (!(ValueOf(depth) > 1e-6 * distance) || !(xi * ValueOf(point.z()) > -distance)) return false;
    const T inverse_depth = 1.0 / depth;
    T x, y;
    if (!distortion.Distort<T>(point.x() * inverse_depth, point.y() * inverse_depth, &x, &y))
      return false;
    *pixel << fx * x + cx, fy * y + cy;
    return true;
  }

  std::optional<Eigen::Vector3d> Unproject(const Eigen::Vector2d& pixel) const;
  void Validate() const;
  MeiProjection Scaled(double factor) const;
};

/// B. Khomutenko, G. Garcia, P. Martinet, "An Enhanced Unified Camera Model", RA-L 2016.
struct EucmProjection {
  double alpha = 0;                       ///< 0..1
  double beta = 1;                        ///< > 0
  double fx = 1, fy = 1, cx = 0, cy = 0;  ///< [px]

  template <typename T>
  bool Project(const Eigen::Matrix<T, 3, 1>& point, Eigen::Matrix<T, 2, 1>* pixel) const {
    using std::sqrt;
    const T& z = point.z();
    const T d = sqrt(beta * (point.x() * point.x() + point.y() * point.y()) + z * z);
    const T depth = alpha * d + (1 - alpha) * z;
    const double distance = ValueOf(d);
    // The second condition is the fold of alpha > 1/2; it follows from the first otherwise.
    if (!(ValueOf(depth) > 1e-6 * distance) || !(alpha * ValueOf(z) > -(1 - alpha) * distance))
      return false;
    const T inverse_depth = 1.0 / depth;
    *pixel << fx * (point.x() * inverse_depth) + cx, fy * (point.y() * inverse_depth) + cy;
    return true;
  }

  std::optional<Eigen::Vector3d> Unproject(const Eigen::Vector2d& pixel) const;
  void Validate() const;
  EucmProjection Scaled(double factor) const;
};

/// V. Usenko, N. Demmel, D. Cremers, "The Double Sphere Camera Model", 3DV 2018, eq. 40-52.
struct DoubleSphereProjection {
  double xi = 0;                          ///< > -1
  double alpha = 0;                       ///< 0..1
  double fx = 1, fy = 1, cx = 0, cy = 0;  ///< [px]

  template <typename T>
  bool Project(const Eigen::Matrix<T, 3, 1>& point, Eigen::Matrix<T, 2, 1>* pixel) const {
    using std::sqrt;
    const T r2 = point.x() * point.x() + point.y() * point.y();
    const T d1 = sqrt(r2 + point.z() * point.z());
    const T z2 = xi * d1 + point.z();
    const T d2 = sqrt(r2 + z2 * z2);
    const T depth = alpha * d2 + (1 - alpha) * z2;
    const double distance = ValueOf(d2);
    // The folds of the second sphere (alpha > 1/2) and of the first (xi > 1).
    if (!(ValueOf(depth) > 1e-6 * distance) || !(alpha * ValueOf(z2) > -(1 - alpha) * distance) ||
        !(xi * ValueOf(point.z()) > -ValueOf(d1)))
      return false;
    const T inverse_depth = 1.0 / depth;
    *pixel << fx * (point.x() * inverse_depth) + cx, fy * (point.y() * inverse_depth) + cy;
    return true;
  }

  std::optional<Eigen::Vector3d> Unproject(const Eigen::Vector2d& pixel) const;
  void Validate() const;
  DoubleSphereProjection Scaled(double factor) const;
};

/// Scaramuzza's model as in MATLAB's fisheyeIntrinsics: the bearing of the point (x, y) of the
/// undistorted sensor is (x, y, a0 + a2 r^2 + a3 r^3 + a4 r^4) with r = |(x, y)| [px], and pixel =
/// [c d; e 1] (x, y) + (cx, cy). The OCamCalib toolbox lets z point backwards: there a0 < 0, and
/// all four coefficients have the other sign (ReadRig turns them). D. Scaramuzza, A. Martinelli, R.
/// Siegwart, "A Toolbox for Easily Calibrating Omnidirectional Cameras", IROS 2006.
struct OcamProjection {
  double a0 = 1, a2 = 0, a3 = 0, a4 = 0;
  double cx = 0, cy = 0;  ///< [px]
  double c = 1, d = 0, e = 0;
  double max_radius = FindMaxRadius(a0, a2, a3, a4);  ///< [px] on the undistorted sensor
  double max_theta = std::atan2(max_radius, BearingZ(max_radius));  ///< [rad] to the axis

  template <typename T>
  bool Project(const Eigen::Matrix<T, 3, 1>& point, Eigen::Matrix<T, 2, 1>* pixel) const {
    using std::sqrt;
    const T& z = point.z();
    const T r2 = point.x() * point.x() + point.y() * point.y();
    T radius_per_meter;
    if (ValueOf(r2) < 1e-12 * ValueOf(z) * ValueOf(z)) {
      if (!(ValueOf(z) > 0)) return false;
      radius_per_meter = (a0 + (a0 * a0 * a2) * (r2 / (z * z))) / z;
    } else {
      const T r = sqrt(r2);
      const double rho = FindRadius(ValueOf(r), ValueOf(z));
      if (!(rho >= 0)) return false;
      // One Newton step in T: rho is converged, so this only adds its derivatives (implicit
      // function theorem).
      const T residual = r * BearingZ(rho) - z * rho;
      const double slope = ValueOf(r) * BearingSlope(rho) - ValueOf(z);
      radius_per_meter = (rho - residual / slope) / r;
    }
    const T x = point.x() * radius_per_meter;
    const T y = point.y() * radius_per_meter;
    *pixel << c * x + d * y + cx, e * x + y + cy;
    return true;
  }

  std::optional<Eigen::Vector3d> Unproject(const Eigen::Vector2d& pixel) const;
  void Validate() const;
  OcamProjection Scaled(double factor) const;

  double BearingZ(double rho) const { return a0 + rho * rho * (a2 + rho * (a3 + rho * a4)); }
  double BearingSlope(double rho) const { return rho * (2 * a2 + rho * (3 * a3 + rho * 4 * a4)); }
  /// Radius on the undistorted sensor [px] of a point `r` beside and `z` along the axis; NaN
  /// outside the domain.
  double FindRadius(double r, double z) const;
  static double FindMaxRadius(double a0, double a2, double a3, double a4);
};

}  // namespace parkade
