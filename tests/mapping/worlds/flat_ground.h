#pragma once

#include "core/ground_texture.h"
#include "core/surface_map.h"
#include "core/triangle_mesh.h"
#include "tests/mapping/worlds/painted_ground.h"

namespace parkade {

/// A flat ground of 30 m x 30 m about the origin with the image of a tile, 1.5 m high.
struct FlatGround {
  SurfaceMap surface;
  TriangleMesh mesh;
  GroundTexture texture;

  explicit FlatGround(const GroundTile& tile) {
    surface.cell_size = 0.25;
    for (int y = -60; y < 60; ++y)
      for (int x = -60; x < 60; ++x)
        surface.cells.push_back({.x = x, .y = y, .height = 1.5F, .free_belief = 1});
    texture.chart_size = 15;
    for (int row = -1; row < 1; ++row)
      for (int column = -1; column < 1; ++column) {
        const cv::Rect part(column < 0 ? 0 : tile.image.cols / 2, row < 0 ? tile.image.rows / 2 : 0,
                            tile.image.cols / 2, tile.image.rows / 2);
        TextureChart chart{
            column * 15.0, (row + 1) * 15.0, tile.image(part), tile.mask(part), {}, column, row, 0};
        const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
        for (const Eigen::Vector2d& corner : {Eigen::Vector2d(0, 0), {15, 0}, {0, 15}}) {
          const Eigen::Vector2d place = corner + 15 * Eigen::Vector2d(column, row);
          mesh.vertices.emplace_back(static_cast<float>(place.x()), static_cast<float>(place.y()),
                                     1.5F);
        }
        chart.triangles.push_back(static_cast<std::uint32_t>(mesh.triangles.size()));
        mesh.triangles.push_back({first, first + 1, first + 2});
        texture.charts.push_back(std::move(chart));
      }
  }
};

}  // namespace parkade
