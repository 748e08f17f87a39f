#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "core/ground_texture.h"
#include "core/surface_map.h"
#include "core/triangle_mesh.h"

namespace parkade {

/// A square of one deck straight from above, with a margin of what lies around it on the same deck.
/// Pixel (column, row) shows the square whose upper left corner is at (left + column * pixel_size,
/// top - row * pixel_size) in site.
struct GroundTile {
  double left = 0, top = 0;  ///< [m] in site
  double pixel_size = 0;     ///< [m]
  double height = 0;         ///< [m] in site, mean
  cv::Mat image;             ///< CV_8UC3 (BGR)
  cv::Mat mask;              ///< CV_8UC1 of the same size: kSure where ground is known
  Eigen::AlignedBox2d
      core;  ///< [m] in site: without the margin; the cores of one deck's tiles do not overlap

  static constexpr std::uint8_t kSure = 255;  ///< ground that images show from near
  static constexpr std::uint8_t kUnsure =
      128;  ///< something was seen: what stands there, ground far off; 0: nothing

  Eigen::Vector2d PlaceOf(double column, double row) const {
    return {left + (column + 0.5) * pixel_size, top - (row + 0.5) * pixel_size};
  }
};

/// The tiles that the charts of a texture lie in, in their order; several charts of one square and
/// one deck (islands of drivable ground) are in one tile. Charts count as the same deck where their
/// mean height is at most `max_step` [m] off; so do the cells of the surface, which go on between
/// parked cars and where ground is not sure enough to be drivable. All is borrowed.
class GroundTiles {
 public:
  GroundTiles(const TriangleMesh& mesh, const SurfaceMap& surface, const GroundTexture& texture,
              double margin, double max_step = 1.5);

  std::size_t size() const { return leaders_.size(); }

  /// Made when asked for: a tile takes more memory than its chart.
  GroundTile Make(std::size_t index) const;

 private:
  bool IsOfDeck(std::size_t a, std::size_t b) const {
    return std::abs(heights_[a] - heights_[b]) <= max_step_;
  }
  void AddCells(GroundTile& tile) const;

  const SurfaceMap* surface_;
  const GroundTexture* texture_;
  double margin_, max_step_;
  std::vector<double> heights_;       ///< [m] of charts
  std::vector<std::size_t> leaders_;  ///< per tile, its first chart
};

}  // namespace parkade
