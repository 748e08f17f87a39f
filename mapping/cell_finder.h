#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <unordered_map>

#include "core/surface_map.h"

namespace parkade {

/// Finds cells of a surface by their place. The surface is borrowed.
class CellFinder {
 public:
  explicit CellFinder(const SurfaceMap& surface);

  /// The cell nearest to a point that lies on the surface or at most two cells off its border; null further away.
  const SurfaceCell* Find(const Eigen::Vector3d& point_in_site) const;

 private:
  static std::uint64_t KeyOf(int x, int y) {
    return (std::uint64_t{static_cast<std::uint32_t>(x)} << 32) | static_cast<std::uint32_t>(y);
  }
  std::span<const SurfaceCell> At(int x, int y) const;

  const SurfaceMap* surface_;
  std::unordered_map<std::uint64_t, std::size_t> first_at_;
};

}  // namespace parkade
