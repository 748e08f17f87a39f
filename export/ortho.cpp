#include "export/ortho.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <opencv2/imgcodecs.hpp>
#include <span>

#include "core/error.h"
#include "core/math/fast_floor.h"

namespace parkade {
namespace {

/// Columns and rows of a grid that lies on the site's axes, both ends included; rows count north.
struct GridBounds {
  int min_x = 0, max_x = 0, min_y = 0, max_y = 0;
};

/// The image that holds `bounds`, where n x n squares of the grid become a pixel so that no side
/// exceeds a size.
struct Canvas {
  int squares_per_pixel = 1;
  int left = 0,
      top = 0;    ///< [pixels] of the upper left one from the site's origin; rows count north
  cv::Mat image;  ///< CV_8UC4

  Canvas(const GridBounds& bounds, int max_size) {
    const int extent = std::max(bounds.max_x - bounds.min_x, bounds.max_y - bounds.min_y) + 1;
    squares_per_pixel = (extent + max_size - 1) / max_size;
    left = FloorDivide(bounds.min_x, squares_per_pixel);
    top = FloorDivide(bounds.max_y, squares_per_pixel);
    const int right = FloorDivide(bounds.max_x, squares_per_pixel);
    const int bottom = FloorDivide(bounds.min_y, squares_per_pixel);
    image = cv::Mat(top - bottom + 1, right - left + 1, CV_8UC4, cv::Scalar::all(0));
  }

  cv::Point PixelOf(int x, int y) const {
    return {FloorDivide(x, squares_per_pixel) - left, top - FloorDivide(y, squares_per_pixel)};
  }

  Orthophoto Take(double square_size) && {
    const double pixel_size = square_size * squares_per_pixel;
    return {std::move(image), pixel_size, left * pixel_size, (top + 1) * pixel_size};
  }
};

GridBounds BoundsOf(std::span<const SurfaceCell> cells) {
  GridBounds bounds;
  if (!cells.empty()) bounds = {cells[0].x, cells[0].x, cells[0].y, cells[0].y};
  for (const SurfaceCell& cell : cells) {
    bounds.min_x = std::min(bounds.min_x, cell.x);
    bounds.max_x = std::max(bounds.max_x, cell.x);
    bounds.min_y = std::min(bounds.min_y, cell.y);
    bounds.max_y = std::max(bounds.max_y, cell.y);
  }
  return bounds;
}

/// The bounds of a chart, in texels from the site's origin.
GridBounds BoundsOf(const TextureChart& chart, double texel_size) {
  const int left = static_cast<int>(std::lround(chart.left / texel_size));
  const int top = static_cast<int>(std::lround(chart.top / texel_size)) - 1;
  return {left, left + chart.image.cols - 1, top - chart.image.rows + 1, top};
}

GridBounds BoundsOf(const GroundTexture& texture) {
  GridBounds bounds = BoundsOf(texture.charts[0], texture.texel_size);
  for (const TextureChart& chart : texture.charts) {
    const GridBounds other = BoundsOf(chart, texture.texel_size);
    bounds = {std::min(bounds.min_x, other.min_x), std::max(bounds.max_x, other.max_x),
              std::min(bounds.min_y, other.min_y), std::max(bounds.max_y, other.max_y)};
  }
  return bounds;
}

/// Charts from the lowest to the highest.
std::vector<const TextureChart*> SortByHeight(const TriangleMesh& mesh,
                                              const GroundTexture& texture) {
  std::vector<std::pair<double, const TextureChart*>> sorted;
  for (const TextureChart& chart : texture.charts) {
    double sum = 0;
    for (const std::uint32_t triangle : chart.triangles)
      for (const std::uint32_t vertex : mesh.triangles[triangle])
        sum += static_cast<double>(mesh.vertices[vertex].z());
    sorted.emplace_back(sum / static_cast<double>(std::max<size_t>(1, chart.triangles.size())),
                        &chart);
  }
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<const TextureChart*> charts;
  for (const auto& [height, chart] : sorted) charts.push_back(chart);
  return charts;
}

}  // namespace

Orthophoto RenderOrthophoto(const SurfaceMap& surface, int max_size) {
  Canvas canvas(BoundsOf(surface.cells), max_size);
  cv::Mat height(canvas.image.size(), CV_32FC1, cv::Scalar(-1e30));
  for (const SurfaceCell& cell : surface.cells) {
    const cv::Point pixel = canvas.PixelOf(cell.x, cell.y);
    if (cell.height <= height.at<float>(pixel)) continue;
    height.at<float>(pixel) = cell.height;
    canvas.image.at<cv::Vec4b>(pixel) = {cell.color[2], cell.color[1], cell.color[0], 255};
  }
  return std::move(canvas).Take(surface.cell_size);
}

Orthophoto RenderOrthophoto(const TriangleMesh& mesh, const GroundTexture& texture, int max_size) {
  Require(!texture.empty(), ErrorCode::kInternal, "there is no texture to make an orthophoto of");
  Canvas canvas(BoundsOf(texture), max_size);
  for (const TextureChart* chart : SortByHeight(mesh, texture)) {
    const GridBounds bounds = BoundsOf(*chart, texture.texel_size);
    for (int row = 0; row < chart->image.rows; ++row)
      for (int column = 0; column < chart->image.cols; ++column) {
        if (chart->mask.at<std::uint8_t>(row, column) == 0) continue;
        const cv::Vec3b& color = chart->image.at<cv::Vec3b>(row, column);
        canvas.image.at<cv::Vec4b>(canvas.PixelOf(bounds.min_x + column, bounds.max_y - row)) = {
            color[0], color[1], color[2], 255};
      }
    texture.Release();
  }
  return std::move(canvas).Take(texture.texel_size);
}

std::string EncodePng(const Orthophoto& ortho) {
  std::vector<unsigned char> png;
  Require(cv::imencode(".png", ortho.image, png), ErrorCode::kInternal,
          "OpenCV could not write the orthophoto");
  return {png.begin(), png.end()};
}

std::string EncodeWorldFile(const Orthophoto& ortho) {
  char text[256];
  std::snprintf(text, sizeof text, "%.9f\n0\n0\n%.9f\n%.9f\n%.9f\n", ortho.pixel_size,
                -ortho.pixel_size, ortho.left + 0.5 * ortho.pixel_size,
                ortho.top - 0.5 * ortho.pixel_size);
  return text;
}

}  // namespace parkade
