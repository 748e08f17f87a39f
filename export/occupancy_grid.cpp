#include "export/occupancy_grid.h"

#include <cmath>
#include <cstdio>

#include "core/error.h"
#include "export/point_cloud.h"

namespace parkade {

OccupancyGrid MakeOccupancyGrid(const TriangleMesh& mesh, const std::string& image_name,
                                const OccupancyGridOptions& options) {
  constexpr char kFree = static_cast<char>(254), kUnknown = static_cast<char>(205);
  constexpr double kMaxCells = 1 << 28;
  Require(options.resolution > 0, ErrorCode::kUsage,
          "the resolution of an occupancy grid must be > 0 m");
  // The lattice of points, half a cell on, is that of the cells' centers.
  TriangleMesh shifted = mesh;
  shifted.origin.head<2>() -= Eigen::Vector2d::Constant(0.5 * options.resolution);
  std::vector<std::pair<long, long>> free;
  for (const ColoredPoint& point : SamplePoints(shifted, options.resolution)) {
    const double z = static_cast<double>(point.point_in_site.z());
    if (z < options.lowest || z > options.highest) continue;
    free.emplace_back(
        std::lround(static_cast<double>(point.point_in_site.x()) / options.resolution),
        std::lround(static_cast<double>(point.point_in_site.y()) / options.resolution));
  }
  Require(!free.empty(), ErrorCode::kInvalidInput, "the map has no ground within these heights");
  auto [left, bottom] = free.front();
  auto [right, top] = free.front();
  for (const auto& [x, y] : free) {
    left = std::min(left, x), right = std::max(right, x);
    bottom = std::min(bottom, y), top = std::max(top, y);
  }
  const long width = right - left + 1, height = top - bottom + 1;
  Require(static_cast<double>(width) * static_cast<double>(height) <= kMaxCells, ErrorCode::kUsage,
          "the occupancy grid would have more than 2^28 cells: choose a coarser resolution");

  OccupancyGrid grid;
  grid.pgm = "P5\n" + std::to_string(width) + " " + std::to_string(height) + "\n255\n";
  const std::size_t begin = grid.pgm.size();
  grid.pgm.append(static_cast<std::size_t>(width * height), kUnknown);
  for (const auto& [x, y] : free)
    grid.pgm[begin + static_cast<std::size_t>((top - y) * width + x - left)] = kFree;
  char text[512];
  std::snprintf(text, sizeof text,
                "image: %s\nmode: trinary\nresolution: %.9g\norigin: [%.9f, %.9f, 0]\nnegate: 0\n"
                "occupied_thresh: 0.65\nfree_thresh: 0.196\n",
                image_name.c_str(), options.resolution,
                static_cast<double>(left) * options.resolution,
                static_cast<double>(bottom) * options.resolution);
  grid.yaml = text;
  return grid;
}

}  // namespace parkade
