#include "core/camera_projections.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <initializer_list>
#include <limits>
#include <string>
#include <utility>

#include "core/error.h"
#include "core/math/polynomial.h"

namespace parkade {
namespace {

// The tangent of 89.94 degrees, where a distorted pinhole ends if no fold ends it before.
constexpr double kMaxTangent = 1e3;
// The same limit for OCam, on its undistorted sensor [px].
constexpr double kMaxSensorRadius = 1e5;
// Share of the radius or angle kept from a fold, where the inverse is ill-conditioned.
constexpr double kFoldMargin = 1e-6;

void RequireFinite(std::initializer_list<std::pair<double, const char*>> intrinsics) {
  for (const auto& [value, name] : intrinsics)
    Require(std::isfinite(value), ErrorCode::kInvalidInput,
            std::string("intrinsic '") + name + "' is not finite");
}

void RequireIn(double value, const char* name, double begin, double end) {
  Require(value >= begin && value <= end, ErrorCode::kInvalidInput,
          std::string("intrinsic '") + name + "' = " + std::to_string(value) + " is outside " +
              std::to_string(begin) + ".." + std::to_string(end));
}

template <typename Projection>
void ValidatePlane(const Projection& lens) {
  for (const auto& [value, name] : {std::pair{lens.fx, "fx"}, std::pair{lens.fy, "fy"}})
    Require(value > 0 && std::isfinite(value), ErrorCode::kInvalidInput,
            std::string("intrinsic '") + name + "' must be a positive number of pixels");
  RequireFinite({{lens.cx, "cx"}, {lens.cy, "cy"}});
}

/// Pixel in the normalized image plane.
template <typename Projection>
Eigen::Vector2d Normalized(const Projection& lens, const Eigen::Vector2d& pixel) {
  return {(pixel.x() - lens.cx) / lens.fx, (pixel.y() - lens.cy) / lens.fy};
}

double ScaledCenter(double center, double factor) { return (center + 0.5) * factor - 0.5; }

template <typename Projection>
Projection Resized(Projection lens, double factor) {
  lens.fx *= factor;
  lens.fy *= factor;
  lens.cx = ScaledCenter(lens.cx, factor);
  lens.cy = ScaledCenter(lens.cy, factor);
  return lens;
}

/// Jacobian of RadTanDistortion::Distort.
Eigen::Matrix2d DistortionJacobian(const RadTanDistortion& lens, double x, double y) {
  const double r2 = x * x + y * y;
  const double radial = 1 + r2 * (lens.k1 + r2 * (lens.k2 + r2 * lens.k3));
  const double slope =
      2 * (lens.k1 + r2 * (2 * lens.k2 + r2 * 3 * lens.k3));  // d radial / d x = slope * x
  Eigen::Matrix2d jacobian;
  jacobian(0, 0) = radial + slope * x * x + 2 * lens.p1 * y + 6 * lens.p2 * x;
  jacobian(0, 1) = jacobian(1, 0) = slope * x * y + 2 * lens.p1 * x + 2 * lens.p2 * y;
  jacobian(1, 1) = radial + slope * y * y + 6 * lens.p1 * y + 2 * lens.p2 * x;
  return jacobian;
}

/// True where the tangential part folds the plane somewhere on the circle.
bool FoldsOnCircle(const RadTanDistortion& lens, double radius) {
  constexpr int kNumAngles = 64;
  for (int i = 0; i < kNumAngles; ++i) {
    const double angle = 2 * M_PI * i / kNumAngles;
    const Eigen::Matrix2d jacobian =
        DistortionJacobian(lens, radius * std::cos(angle), radius * std::sin(angle));
    if (!(jacobian.determinant() > 0 && jacobian.trace() > 0)) return true;
  }
  return false;
}

}  // namespace

double RadTanDistortion::FindMaxRadiusSquared(double k1, double k2, double p1, double p2,
                                              double k3) {
  double max_radius = kMaxTangent;
  const std::vector<double> folds =
      FindSignChanges({1, 3 * k1, 5 * k2, 7 * k3}, 0, kMaxTangent * kMaxTangent);
  if (!folds.empty()) max_radius = std::sqrt(folds.front()) * (1 - kFoldMargin);
  if (p1 == 0 && p2 == 0) return max_radius * max_radius;

  const RadTanDistortion lens{k1, k2, p1, p2, k3, max_radius * max_radius};
  constexpr int kNumCircles = 256;
  double good_radius = 0;
  for (int i = 1; i <= kNumCircles; ++i) {
    // Circles lie denser toward the center: folds of the tangential part alone are far out.
    const double fraction = static_cast<double>(i) / kNumCircles;
    const double radius =
        folds.empty() ? max_radius * fraction * fraction * fraction : max_radius * fraction;
    if (FoldsOnCircle(lens, radius)) break;
    good_radius = radius;
  }
  return good_radius * good_radius;
}

std::optional<Eigen::Vector2d> RadTanDistortion::Undistort(const Eigen::Vector2d& distorted) const {
  // Start from the radial part alone, then Newton in the plane.
  const double max_radius = std::sqrt(max_radius_squared);
  const double radius = distorted.norm();
  const auto radial = [&](double r) {
    const double r2 = r * r;
    return std::pair{r * (1 + r2 * (k1 + r2 * (k2 + r2 * k3))) - radius,
                     1 + r2 * (3 * k1 + r2 * (5 * k2 + r2 * 7 * k3))};
  };
  const double start =
      SolveIncreasing(radial, std::min(radius, max_radius), max_radius).value_or(max_radius);
  Eigen::Vector2d point = radius > 0 ? Eigen::Vector2d(distorted * (start / radius)) : distorted;
  const RadTanDistortion everywhere{k1, k2, p1, p2, k3, std::numeric_limits<double>::infinity()};
  for (int iteration = 0; iteration < 30; ++iteration) {
    Eigen::Vector2d projected;
    everywhere.Distort(point.x(), point.y(), &projected.x(), &projected.y());
    const Eigen::Vector2d error = projected - distorted;
    const Eigen::Matrix2d jacobian = DistortionJacobian(*this, point.x(), point.y());
    const Eigen::Vector2d step = jacobian.inverse() * error;
    if (error.norm() <= 1e-14 * (1 + radius) && point.squaredNorm() <= max_radius_squared)
      return point;
    if (!step.allFinite()) return std::nullopt;
    point -= step;
  }
  return std::nullopt;
}

void RadTanDistortion::Validate() const {
  RequireFinite({{k1, "k1"}, {k2, "k2"}, {p1, "p1"}, {p2, "p2"}, {k3, "k3"}});
}

std::optional<Eigen::Vector3d> PinholeProjection::Unproject(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d point = Normalized(*this, pixel);
  if (!IsInFrontOfPlane(point.x(), point.y(), 1)) return std::nullopt;
  return point.homogeneous().normalized();
}

void PinholeProjection::Validate() const { ValidatePlane(*this); }

PinholeProjection PinholeProjection::Scaled(double factor) const { return Resized(*this, factor); }

std::optional<Eigen::Vector3d> RadTanProjection::Unproject(const Eigen::Vector2d& pixel) const {
  const std::optional<Eigen::Vector2d> point = distortion.Undistort(Normalized(*this, pixel));
  if (!point) return std::nullopt;
  return point->homogeneous().normalized();
}

void RadTanProjection::Validate() const {
  ValidatePlane(*this);
  distortion.Validate();
}

RadTanProjection RadTanProjection::Scaled(double factor) const { return Resized(*this, factor); }

double KannalaBrandtProjection::FindMaxTheta(double k1, double k2, double k3, double k4) {
  // The slope of r(t) is a quartic in t^2.
  const std::vector<double> folds =
      FindSignChanges({1, 3 * k1, 5 * k2, 7 * k3, 9 * k4}, 0, M_PI * M_PI);
  return folds.empty() ? M_PI : std::sqrt(folds.front()) * (1 - kFoldMargin);
}

std::optional<Eigen::Vector3d> KannalaBrandtProjection::Unproject(
    const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d point = Normalized(*this, pixel);
  const double radius = point.norm();
  if (radius < 1e-12) return Eigen::Vector3d(point.x(), point.y(), 1).normalized();
  const auto radius_error = [&](double theta) {
    const double t2 = theta * theta;
    return std::pair{theta * (1 + t2 * (k1 + t2 * (k2 + t2 * (k3 + t2 * k4)))) - radius,
                     1 + t2 * (3 * k1 + t2 * (5 * k2 + t2 * (7 * k3 + t2 * 9 * k4)))};
  };
  const std::optional<double> theta =
      SolveIncreasing(radius_error, std::min(radius, max_theta), max_theta);
  if (!theta) return std::nullopt;
  const double scale = std::sin(*theta) / radius;
  return Eigen::Vector3d(point.x() * scale, point.y() * scale, std::cos(*theta));
}

void KannalaBrandtProjection::Validate() const {
  ValidatePlane(*this);
  RequireFinite({{k1, "k1"}, {k2, "k2"}, {k3, "k3"}, {k4, "k4"}});
}

KannalaBrandtProjection KannalaBrandtProjection::Scaled(double factor) const {
  return Resized(*this, factor);
}

std::optional<Eigen::Vector3d> MeiProjection::Unproject(const Eigen::Vector2d& pixel) const {
  const std::optional<Eigen::Vector2d> point = distortion.Undistort(Normalized(*this, pixel));
  if (!point) return std::nullopt;
  const double r2 = point->squaredNorm();
  const double discriminant = 1 + (1 - xi * xi) * r2;
  if (!(discriminant >= 0)) return std::nullopt;
  const double scale = (xi + std::sqrt(discriminant)) / (1 + r2);
  return Eigen::Vector3d(scale * point->x(), scale * point->y(), scale - xi).normalized();
}

void MeiProjection::Validate() const {
  ValidatePlane(*this);
  distortion.Validate();
  RequireIn(xi, "xi", 0, 100);
}

MeiProjection MeiProjection::Scaled(double factor) const { return Resized(*this, factor); }

std::optional<Eigen::Vector3d> EucmProjection::Unproject(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d point = Normalized(*this, pixel);
  const double r2 = point.squaredNorm();
  const double discriminant = 1 - (2 * alpha - 1) * beta * r2;
  if (!(discriminant >= 0)) return std::nullopt;
  const double z = (1 - alpha * alpha * beta * r2) / (alpha * std::sqrt(discriminant) + 1 - alpha);
  return Eigen::Vector3d(point.x(), point.y(), z).normalized();
}

void EucmProjection::Validate() const {
  ValidatePlane(*this);
  RequireIn(alpha, "alpha", 0, 1);
  RequireIn(beta, "beta", 1e-6, 1e6);
}

EucmProjection EucmProjection::Scaled(double factor) const { return Resized(*this, factor); }

std::optional<Eigen::Vector3d> DoubleSphereProjection::Unproject(
    const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d point = Normalized(*this, pixel);
  const double r2 = point.squaredNorm();
  const double discriminant = 1 - (2 * alpha - 1) * r2;
  if (!(discriminant >= 0)) return std::nullopt;
  const double z = (1 - alpha * alpha * r2) / (alpha * std::sqrt(discriminant) + 1 - alpha);
  const double root = z * z + (1 - xi * xi) * r2;
  if (!(root >= 0)) return std::nullopt;
  const double scale = (z * xi + std::sqrt(root)) / (z * z + r2);
  return Eigen::Vector3d(scale * point.x(), scale * point.y(), scale * z - xi).normalized();
}

void DoubleSphereProjection::Validate() const {
  ValidatePlane(*this);
  RequireIn(xi, "xi", -0.999999, 100);
  RequireIn(alpha, "alpha", 0, 1);
}

DoubleSphereProjection DoubleSphereProjection::Scaled(double factor) const {
  return Resized(*this, factor);
}

double OcamProjection::FindMaxRadius(double a0, double a2, double a3, double a4) {
  // The angle to the axis grows while z - r dz/dr > 0.
  const std::vector<double> folds =
      FindSignChanges({a0, 0, -a2, -2 * a3, -3 * a4}, 0, kMaxSensorRadius);
  return folds.empty() ? kMaxSensorRadius : folds.front() * (1 - kFoldMargin);
}

double OcamProjection::FindRadius(double r, double z) const {
  const double theta = std::atan2(r, z);
  if (!(theta <= max_theta)) return std::numeric_limits<double>::quiet_NaN();
  // sin(theta) z(rho) - cos(theta) rho falls through its only root.
  const double norm = std::hypot(r, z);
  const double sine = r / norm, cosine = z / norm;
  const auto miss = [&](double rho) {
    return std::pair{cosine * rho - sine * BearingZ(rho), cosine - sine * BearingSlope(rho)};
  };
  // Fisheyes are nearly equidistant: pixels per radian at the axis are a0.
  const double start = std::min(a0 * theta, max_radius);
  return SolveIncreasing(miss, start, max_radius).value_or(max_radius);
}

std::optional<Eigen::Vector3d> OcamProjection::Unproject(const Eigen::Vector2d& pixel) const {
  const double u = pixel.x() - cx, v = pixel.y() - cy;
  const double inverse_determinant = 1 / (c - d * e);
  const double x = (u - d * v) * inverse_determinant;
  const double y = (c * v - e * u) * inverse_determinant;
  const double radius = std::hypot(x, y);
  if (!(radius <= max_radius)) return std::nullopt;
  return Eigen::Vector3d(x, y, BearingZ(radius)).normalized();
}

void OcamProjection::Validate() const {
  RequireFinite(
      {{a2, "a2"}, {a3, "a3"}, {a4, "a4"}, {cx, "cx"}, {cy, "cy"}, {c, "c"}, {d, "d"}, {e, "e"}});
  Require(a0 > 0 && std::isfinite(a0), ErrorCode::kInvalidInput,
          "intrinsic 'a0' must be a positive number of pixels");
  Require(c - d * e > 0.1, ErrorCode::kInvalidInput,
          "the affine part c, d, e of an ocam lens is degenerate");
}

OcamProjection OcamProjection::Scaled(double factor) const {
  return {.a0 = a0 * factor,
          .a2 = a2 / factor,
          .a3 = a3 / (factor * factor),
          .a4 = a4 / (factor * factor * factor),
          .cx = ScaledCenter(cx, factor),
          .cy = ScaledCenter(cy, factor),
          .c = c,
          .d = d,
          .e = e};
}

}  // namespace parkade
