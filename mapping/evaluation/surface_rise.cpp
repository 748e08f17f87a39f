#include "mapping/evaluation/surface_rise.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <vector>

#include "core/math/statistics.h"

namespace parkade {
namespace {

constexpr double kMinArea = 2;  // [m^2] in both
constexpr float kFree = 0.65F;

std::uint64_t KeyOf(double x, double y, double cell_size) {
  const auto column = static_cast<std::int32_t>(std::floor(x / cell_size));
  const auto row = static_cast<std::int32_t>(std::floor(y / cell_size));
  return (std::uint64_t{static_cast<std::uint32_t>(row)} << 32) |
         static_cast<std::uint32_t>(column);
}

}  // namespace

std::optional<double> MedianRise(const SurfaceMap& from, const SurfaceMap& to,
                                 const Rigid3& to_from_from) {
  std::unordered_multimap<std::uint64_t, double>
      heights;  // of the earlier ground, where the later site has it
  heights.reserve(from.cells.size());
  for (const SurfaceCell& cell : from.cells) {
    if (cell.free_belief < kFree) continue;
    const Eigen::Vector3d point = to_from_from * Eigen::Vector3d((cell.x + 0.5) * from.cell_size,
                                                                 (cell.y + 0.5) * from.cell_size,
                                                                 static_cast<double>(cell.height));
    heights.emplace(KeyOf(point.x(), point.y(), to.cell_size), point.z());
  }
  std::vector<double> rises;
  for (const SurfaceCell& cell : to.cells) {
    if (cell.free_belief < kFree) continue;
    const auto [begin, end] = heights.equal_range(
        KeyOf((cell.x + 0.5) * to.cell_size, (cell.y + 0.5) * to.cell_size, to.cell_size));
    if (begin == end) continue;
    double rise = static_cast<double>(cell.height) - begin->second;
    for (auto height = begin; height != end; ++height)
      if (const double other = static_cast<double>(cell.height) - height->second;
          std::abs(other) < std::abs(rise))
        rise = other;
    rises.push_back(rise);
  }
  if (static_cast<double>(rises.size()) * to.cell_size * to.cell_size < kMinArea)
    return std::nullopt;
  return Median(std::move(rises));
}

}  // namespace parkade
