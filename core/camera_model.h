#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <variant>

#include "core/camera_projections.h"

namespace parkade {

/// One calibrated lens: a projection of core/camera_projections.h and the size
/// of its image. Camera frame: z forward, x right, y down. Pixel (0, 0) is the
/// center of the upper left pixel. Thread-safe: immutable.
class CameraModel {
 public:
  using Projection =
      std::variant<PinholeProjection, RadTanProjection, KannalaBrandtProjection, MeiProjection,
                   EucmProjection, DoubleSphereProjection, OcamProjection>;
  using Jacobian = Eigen::Matrix<double, 2, 3>;

  CameraModel() = default;

  /// Throws Error{kInvalidInput} with one sentence when an intrinsic is out of
  /// its range or not finite, or the size is not in 1..16384.
  CameraModel(Projection projection, int width, int height);

  /// Pixel of a point [m] (or direction), or nothing where the model has none
  /// (outside its validity domain). The pixel may lie outside the image: see
  /// IsInImage. Valid beyond 180 degrees for the fisheye models.
  std::optional<Eigen::Vector2d> Project(const Eigen::Vector3d& point_in_camera) const;

  /// The same with d pixel / d point_in_camera.
  std::optional<Eigen::Vector2d> Project(const Eigen::Vector3d& point_in_camera,
                                         Jacobian* jacobian) const;

  /// Unit bearing of a pixel, or nothing outside the validity domain.
  std::optional<Eigen::Vector3d> Unproject(const Eigen::Vector2d& pixel) const;

  /// True for pixels whose center lies at least `margin` [px] inside the image.
  bool IsInImage(const Eigen::Vector2d& pixel, double margin = 0) const;

  /// Pixels per radian at a pixel: the mean of the two principal stretches.
  /// Nothing where Unproject has nothing.
  std::optional<double> PixelsPerRadian(const Eigen::Vector2d& pixel) const;

  /// The same lens for an image scaled by `factor` (e.g. 0.5 for a half-size
  /// image made by area averaging, pixel centers kept consistent).
  CameraModel Scaled(double factor) const;

  const Projection& projection() const { return projection_; }
  int width() const { return width_; }
  int height() const { return height_; }

 private:
  Projection projection_;
  int width_ = 0;
  int height_ = 0;
};

}  // namespace parkade
