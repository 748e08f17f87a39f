#include "export/lanelet2/corner_heights.h"

#include <Eigen/LU>
#include <cmath>

namespace parkade {
namespace {

/// The height of the plane through a slot's entrance and one side, where the slot or what lies
/// within a cell of it is.
std::optional<double> HeightIn(const ParkingSlot& slot, const Eigen::Vector3d& point,
                               double cell_size) {
  const Eigen::Vector3d across = slot.corners[1] - slot.corners[0];
  const Eigen::Vector3d inwards = slot.corners[3] - slot.corners[0];
  Eigen::Matrix2d sides;
  sides << across.head<2>(), inwards.head<2>();
  const Eigen::Vector2d share = sides.inverse() * (point.head<2>() - slot.corners[0].head<2>());
  const double slack = 2 * cell_size / slot.Width();
  if (share.minCoeff() < -slack || share.maxCoeff() > 1 + slack) return std::nullopt;
  return slot.corners[0].z() + share.x() * across.z() + share.y() * inwards.z();
}

}  // namespace

CornerHeights::CornerHeights(std::span<const FreeSheet* const> sheets,
                             std::span<const ParkingSlot* const> slots, double cell_size)
    : slots_(slots.begin(), slots.end()), cell_size_(cell_size) {
  for (const FreeSheet* sheet : sheets)
    for (const Ring& ring : sheet->rings)
      for (size_t i = 0; i < ring.size(); ++i) {
        const Eigen::Vector3d &from = ring[i], &to = ring[(i + 1) % ring.size()];
        const auto num_steps = std::lround((to - from).head<2>().norm() / cell_size);
        for (long step = 0; step < num_steps; ++step) {
          const double share = static_cast<double>(step) / static_cast<double>(num_steps);
          const Eigen::Vector3d corner = from + share * (to - from);
          heights_.try_emplace(KeyOf(corner), corner.z());
        }
      }
}

std::int64_t CornerHeights::KeyOf(const Eigen::Vector3d& corner) const {
  return CellKey(static_cast<int>(std::lround(corner.x() / cell_size_)),
                 static_cast<int>(std::lround(corner.y() / cell_size_)));
}

std::optional<double> CornerHeights::At(const Eigen::Vector3d& corner) const {
  if (const auto found = heights_.find(KeyOf(corner)); found != heights_.end())
    return found->second;
  for (const ParkingSlot* slot : slots_)
    if (const std::optional<double> height = HeightIn(*slot, corner, cell_size_)) return height;
  return std::nullopt;
}

Ring CornerHeights::Lift(Ring ring) const {
  std::vector<size_t> unknown;
  double sum = 0;
  for (size_t i = 0; i < ring.size(); ++i) {
    const std::optional<double> height = At(ring[i]);
    if (!height) unknown.push_back(i);
    ring[i].z() = height.value_or(0);
    sum += ring[i].z();
  }
  const auto num_known = static_cast<double>(ring.size() - unknown.size());
  for (const size_t i : unknown) ring[i].z() = num_known > 0 ? sum / num_known : 0;
  return ring;
}

}  // namespace parkade
