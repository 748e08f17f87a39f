#include "core/camera_model.h"

#include <Eigen/LU>
#include <cmath>
#include <utility>

#include "core/error.h"

namespace parkade {
namespace {

constexpr int kMaxSize = 16384;

}  // namespace

CameraModel::CameraModel(Projection projection, int width, int height)
    : projection_(std::move(projection)), width_(width), height_(height) {
  Require(width >= 1 && width <= kMaxSize && height >= 1 && height <= kMaxSize,
          ErrorCode::kInvalidInput,
          "the image size " + std::to_string(width) + " x " + std::to_string(height) +
              " is not in 1.." + std::to_string(kMaxSize));
  std::visit([](const auto& lens) { lens.Validate(); }, projection_);
}

std::optional<Eigen::Vector2d> CameraModel::Project(const Eigen::Vector3d& point_in_camera) const {
  Eigen::Vector2d pixel;
  const bool is_valid = std::visit(
      [&](const auto& lens) { return lens.Project(point_in_camera, &pixel); }, projection_);
  if (!is_valid || !pixel.allFinite()) return std::nullopt;
  return pixel;
}

std::optional<Eigen::Vector2d> CameraModel::Project(const Eigen::Vector3d& point_in_camera,
                                                    Jacobian* jacobian) const {
  Eigen::Matrix<Dual<3>, 3, 1> point;
  for (int i = 0; i < 3; ++i) point[i] = Dual<3>::Variable(point_in_camera[i], i);
  Eigen::Matrix<Dual<3>, 2, 1> pixel;
  const bool is_valid =
      std::visit([&](const auto& lens) { return lens.Project(point, &pixel); }, projection_);
  if (!is_valid || !std::isfinite(pixel.x().a) || !std::isfinite(pixel.y().a)) return std::nullopt;
  jacobian->row(0) = pixel.x().v;
  jacobian->row(1) = pixel.y().v;
  return Eigen::Vector2d(pixel.x().a, pixel.y().a);
}

std::optional<Eigen::Vector3d> CameraModel::Unproject(const Eigen::Vector2d& pixel) const {
  if (!pixel.allFinite()) return std::nullopt;
  return std::visit([&](const auto& lens) { return lens.Unproject(pixel); }, projection_);
}

bool CameraModel::IsInImage(const Eigen::Vector2d& pixel, double margin) const {
  return pixel.x() >= margin && pixel.y() >= margin && pixel.x() <= width_ - 1 - margin &&
         pixel.y() <= height_ - 1 - margin;
}

std::optional<double> CameraModel::PixelsPerRadian(const Eigen::Vector2d& pixel) const {
  const std::optional<Eigen::Vector3d> bearing = Unproject(pixel);
  Jacobian jacobian;
  if (!bearing || !Project(*bearing, &jacobian)) return std::nullopt;
  // The Jacobian at a unit bearing has no part along it, so its two singular values are the
  // stretches s1, s2: (s1 + s2)^2 = tr(J J^T) + 2 sqrt(det(J J^T)).
  const Eigen::Matrix2d squared = jacobian * jacobian.transpose();
  return 0.5 * std::sqrt(squared.trace() + 2 * std::sqrt(std::max(0.0, squared.determinant())));
}

CameraModel CameraModel::Scaled(double factor) const {
  Require(factor > 0 && std::isfinite(factor), ErrorCode::kInternal,
          "an image cannot be scaled by a factor <= 0");
  const auto scaled_size = [&](int size) { return static_cast<int>(std::lround(size * factor)); };
  Projection scaled =
      std::visit([&](const auto& lens) -> Projection { return lens.Scaled(factor); }, projection_);
  return {std::move(scaled), scaled_size(width_), scaled_size(height_)};
}

}  // namespace parkade
