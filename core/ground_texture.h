#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "core/files/file_backed_vector.h"

namespace parkade {

/// An image of a stretch of ground, straight from above: texel (column, row) shows the square whose
/// upper left corner is at (left + column * texel_size, top - row * texel_size) in site. Rows run
/// south, columns east.
struct TextureChart {
  double left = 0, top = 0;  ///< [m] in site, of the image's upper left corner
  cv::Mat image;             ///< CV_8UC3 (BGR, sRGB); beyond the mesh its border colors go on
  cv::Mat mask;              ///< CV_8UC1 of the same size: 0 off the mesh, kPainted or kPlain on it
  std::vector<std::uint32_t> triangles;  ///< of the mesh, painted by this chart, increasing
  int column = 0, row = 0;  ///< of the square of ground that the triangles' centers lie in
  int layer = 0;            ///< counts where decks lie above each other in one square

  static constexpr std::uint8_t kPainted = 255;  ///< by images
  static constexpr std::uint8_t kPlain =
      128;  ///< no image shows it from near: it has the color of a cell
};

/// The texture of a mesh: each triangle belongs to exactly one chart. No charts: the mesh has
/// vertex colors only.
struct GroundTexture {
  double texel_size = 0.02;          ///< [m]
  double chart_size = 24;            ///< [m] edge of the squares
  std::vector<TextureChart> charts;  ///< sorted by row, column, layer
  std::vector<std::shared_ptr<const FileBackedVector<std::uint8_t>>> pixels =
      {};  ///< where images of large maps lie

  bool empty() const { return charts.empty(); }

  /// Takes the images of a large map out of memory until they are looked at again. Call between two
  /// charts when going through all of them.
  void Release() const {
    for (const auto& array : pixels) ReleaseMemory(*array);
  }
};

}  // namespace parkade
