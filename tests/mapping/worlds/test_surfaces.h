#pragma once

#include <cmath>
#include <functional>
#include <map>

#include "core/surface_map.h"
#include "core/triangle_mesh.h"

namespace parkade {

/// A free, gray surface of the cells [0, width) x [0, height) with heights of `height_at` (x, y of
/// the center [m]).
inline SurfaceMap MakeSurface(int width, int height, double cell_size,
                              const std::function<double(double, double)>& height_at) {
  SurfaceMap surface{cell_size, {}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      surface.cells.push_back(
          {.x = x,
           .y = y,
           .height = static_cast<float>(height_at((x + 0.5) * cell_size, (y + 0.5) * cell_size)),
           .height_sigma = 0.02F,
           .free_belief = 0.95F,
           .color = {100, 100, 100}});
  return surface;
}

/// A rectangle [x0, x1] x [y0, y1] at height z as two triangles.
inline void AddRectangle(TriangleMesh& mesh, double x0, double y0, double x1, double y1, double z) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const Eigen::Vector3d& corner : {Eigen::Vector3d(x0, y0, z), Eigen::Vector3d(x1, y0, z),
                                        Eigen::Vector3d(x1, y1, z), Eigen::Vector3d(x0, y1, z)}) {
    mesh.vertices.push_back(corner.cast<float>());
    mesh.normals.push_back(Eigen::Vector3f::UnitZ());
    mesh.colors.push_back({128, 128, 128});
    mesh.height_sigmas.push_back(0);
  }
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
}

/// How often each directed edge occurs; a manifold has each at most once.
template <typename Triangles>
std::map<std::pair<std::uint32_t, std::uint32_t>, int> CountDirectedEdges(
    const Triangles& triangles) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> count;
  for (const auto& triangle : triangles)
    for (size_t i = 0; i < 3; ++i) ++count[{triangle[i], triangle[(i + 1) % 3]}];
  return count;
}

}  // namespace parkade
