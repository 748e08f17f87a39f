#include "mapping/surface/visibility_horizon.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "mapping/surface/ray_direction.h"

namespace parkade {
namespace {

constexpr double kStep = 0.1;          // [m] along a ray
constexpr double kNearest = 0.8;       // [m]
constexpr double kMinObstacle = 0.25;  // [m] along a ray; less is a hole in what is known
constexpr float kMargin = 0.1F;        // [m] of an outline
constexpr double kPiece = 0.25;        // [m] of a ray, of which an image says whether it stands
constexpr int kMinStanding = 2;        // samples in a piece

/// Low things hide nothing, and the own car is known.
bool Stands(const GroundSample& sample) {
  switch (sample.surface) {
    case SurfaceClass::kVehicle:
    case SurfaceClass::kPerson:
    case SurfaceClass::kStructure:
    case SurfaceClass::kUnknown: return !sample.is_free && !sample.IsBeyond();
    default: return false;
  }
}

}  // namespace

FreeRays::FreeRays(const Rigid3& site_from_camera, const Rigid3& site_from_ground, double max_range,
                   const FreeClearance& clearance)
    : eye_(site_from_camera.translation.head<2>()), max_range_(max_range), clearance_(&clearance) {
  const Eigen::Vector3d normal = site_from_ground.rotation * Eigen::Vector3d::UnitZ();
  slope_ = -normal.head<2>() / normal.z();
  height_ =
      site_from_ground.translation.z() + slope_.dot(eye_ - site_from_ground.translation.head<2>());
}

float FreeRays::RangeAlong(int direction) const {
  const double angle =
      (direction + 0.5) / kNumRayDirections * 2 * std::numbers::pi - std::numbers::pi;
  const Eigen::Vector2d along(std::cos(angle), std::sin(angle));
  const CellFinder& cells = clearance_->cells();
  double last_free = kNearest;
  const int num_steps = static_cast<int>(std::ceil((max_range_ - kNearest) / kStep));
  for (int step = 0; step < num_steps; ++step) {
    double range = kNearest + step * kStep;
    const Eigen::Vector2d place = eye_ + range * along;
    const SurfaceCell* cell =
        cells.Find({place.x(), place.y(), height_ + range * slope_.dot(along)});
    if (cell != nullptr && cell->free_belief > 0.5F) {
      // Whatever the ray meets within the clearance is free, too.
      const int clear = static_cast<int>(clearance_->Around(place, *cell) / kStep - 1e-6);
      step += std::clamp(clear, 0, num_steps - 1 - step);
      range = last_free = kNearest + step * kStep;
    }
    if (range - last_free >= kMinObstacle) return static_cast<float>(last_free);
  }
  return static_cast<float>(max_range_);
}

bool FreeRays::Reach(const Eigen::Vector2d& point) const {
  const Eigen::Vector2d ray = point - eye_;
  return static_cast<float>(ray.norm()) <= RangeAlong(DirectionOf(ray)) + kMargin;
}

VisibilityHorizon::VisibilityHorizon(const FreeRays& rays) {
  ranges_.reserve(kNumRayDirections);
  for (int i = 0; i < kNumRayDirections; ++i) ranges_.push_back(rays.RangeAlong(i));
}

void VisibilityHorizon::HideBehind(const PosedGroundPatch& seen, const Eigen::Vector2d& eye) {
  if (ranges_.empty()) return;
  const float max_range = *std::max_element(ranges_.begin(), ranges_.end());
  const auto num_pieces = static_cast<std::size_t>(max_range / kPiece) + 1;
  std::vector<std::array<std::uint16_t, 2>> counts(ranges_.size() * num_pieces);  // free, standing
  for (const GroundSample& sample : seen.patch.samples) {
    const bool stands = Stands(sample);
    if (!stands && !sample.is_free) continue;
    const Eigen::Vector3d point = seen.site_from_body * sample.point_in_body.cast<double>();
    const Eigen::Vector2d ray = point.head<2>() - eye;
    const auto piece = static_cast<std::size_t>(ray.norm() / kPiece);
    if (piece >= num_pieces) continue;
    ++counts[static_cast<std::size_t>(DirectionOf(ray)) * num_pieces + piece][stands ? 1 : 0];
  }
  const std::size_t num_directions = ranges_.size();
  for (std::size_t i = 0; i < num_directions; ++i)
    for (std::size_t piece = 0; piece < num_pieces; ++piece) {
      const auto [free, standing] = counts[i * num_pieces + piece];
      if (standing < kMinStanding || standing < free) continue;
      const auto range = static_cast<float>(kPiece * static_cast<double>(piece)) - 2 * kMargin;
      for (const std::size_t k : {i + num_directions - 1, i, i + 1})  // its rims, too
        ranges_[k % num_directions] = std::min(ranges_[k % num_directions], range);
      break;
    }
}

bool VisibilityHorizon::Shows(const Eigen::Vector2d& eye, const Eigen::Vector2d& point) const {
  if (ranges_.empty()) return true;
  const Eigen::Vector2d ray = point - eye;
  return static_cast<float>(ray.norm()) <=
         ranges_[static_cast<std::size_t>(DirectionOf(ray))] + kMargin;
}

}  // namespace parkade
