#include "mapping/surface/visibility_horizon.h"

#include <cmath>
#include <numbers>

namespace parkade {
namespace {

constexpr int kNumDirections = 256;
constexpr double kStep = 0.1;          // [m] along a ray
constexpr double kNearest = 0.8;       // [m]
constexpr double kMinObstacle = 0.25;  // [m] along a ray; less is a hole in what is known
constexpr float kMargin = 0.1F;        // [m] of an outline

/// The direction of a ray, 0 to kNumDirections - 1.
int DirectionOf(const Eigen::Vector2d& ray) {
  const double turn = (std::atan2(ray.y(), ray.x()) + std::numbers::pi) / (2 * std::numbers::pi);
  return static_cast<int>(turn * kNumDirections) % kNumDirections;
}

}  // namespace

VisibilityHorizon::VisibilityHorizon(const Rigid3& site_from_camera, const Rigid3& site_from_ground,
                                     double max_range, const CellFinder& cells)
    : ranges_(kNumDirections, static_cast<float>(max_range)) {
  const Eigen::Vector3d normal = site_from_ground.rotation * Eigen::Vector3d::UnitZ();
  const Eigen::Vector2d slope = -normal.head<2>() / normal.z();
  const Eigen::Vector2d eye = site_from_camera.translation.head<2>();
  const double height =
      site_from_ground.translation.z() + slope.dot(eye - site_from_ground.translation.head<2>());
  for (int i = 0; i < kNumDirections; ++i) {
    const double angle = (i + 0.5) / kNumDirections * 2 * std::numbers::pi - std::numbers::pi;
    const Eigen::Vector2d along(std::cos(angle), std::sin(angle));
    double last_free = kNearest;
    for (double range = kNearest; range < max_range; range += kStep) {
      const Eigen::Vector2d place = eye + range * along;
      const SurfaceCell* cell =
          cells.Find({place.x(), place.y(), height + range * slope.dot(along)});
      if (cell != nullptr && cell->free_belief > 0.5F) last_free = range;
      if (range - last_free < kMinObstacle) continue;
      ranges_[static_cast<std::size_t>(i)] = static_cast<float>(last_free);
      break;
    }
  }
}

bool VisibilityHorizon::Shows(const Eigen::Vector2d& eye, const Eigen::Vector2d& point) const {
  if (ranges_.empty()) return true;
  const Eigen::Vector2d ray = point - eye;
  return static_cast<float>(ray.norm()) <=
         ranges_[static_cast<std::size_t>(DirectionOf(ray))] + kMargin;
}

}  // namespace parkade
