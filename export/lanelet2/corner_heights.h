#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "core/ground_markings.h"
#include "export/free_space.h"

namespace parkade {

/// The heights of one level's ground at corners of cells: along the outlines of its sheets as these
/// have them, in and beside its slots as their corners have them. Borrows the slots.
class CornerHeights {
 public:
  CornerHeights(std::span<const FreeSheet* const> sheets, std::span<const ParkingSlot* const> slots,
                double cell_size);

  /// Gives each corner its height [m]; where none is known, the mean of the ring's others.
  Ring Lift(Ring ring) const;

 private:
  std::int64_t KeyOf(const Eigen::Vector3d& corner) const;
  std::optional<double> At(const Eigen::Vector3d& corner) const;

  std::vector<const ParkingSlot*> slots_;
  double cell_size_;
  std::unordered_map<std::int64_t, double> heights_;
};

}  // namespace parkade
