#include "export/ortho.h"

#include <algorithm>
#include <cstdio>
#include <opencv2/imgcodecs.hpp>

#include "core/error.h"

namespace parkade {
namespace {

int FloorDivide(int value, int divisor) { return value >= 0 ? value / divisor : -((-value + divisor - 1) / divisor); }

struct CellBounds {
  int min_x = 0, max_x = 0, min_y = 0, max_y = 0;
};

CellBounds FindBounds(const std::vector<SurfaceCell>& cells) {
  CellBounds bounds;
  if (!cells.empty()) bounds = {cells[0].x, cells[0].x, cells[0].y, cells[0].y};
  for (const SurfaceCell& cell : cells) {
    bounds.min_x = std::min(bounds.min_x, cell.x);
    bounds.max_x = std::max(bounds.max_x, cell.x);
    bounds.min_y = std::min(bounds.min_y, cell.y);
    bounds.max_y = std::max(bounds.max_y, cell.y);
  }
  return bounds;
}

}  // namespace

Orthophoto RenderOrthophoto(const SurfaceMap& surface, int max_size) {
  const CellBounds cells = FindBounds(surface.cells);
  const int extent = std::max(cells.max_x - cells.min_x, cells.max_y - cells.min_y) + 1;
  const int cells_per_pixel = (extent + max_size - 1) / max_size;
  const int left = FloorDivide(cells.min_x, cells_per_pixel), right = FloorDivide(cells.max_x, cells_per_pixel);
  const int bottom = FloorDivide(cells.min_y, cells_per_pixel), top = FloorDivide(cells.max_y, cells_per_pixel);

  cv::Mat image(top - bottom + 1, right - left + 1, CV_8UC4, cv::Scalar::all(0));
  cv::Mat height(image.size(), CV_32FC1, cv::Scalar(-1e30));
  for (const SurfaceCell& cell : surface.cells) {
    const cv::Point pixel(FloorDivide(cell.x, cells_per_pixel) - left, top - FloorDivide(cell.y, cells_per_pixel));
    if (cell.height <= height.at<float>(pixel)) continue;
    height.at<float>(pixel) = cell.height;
    image.at<cv::Vec4b>(pixel) = {cell.color[2], cell.color[1], cell.color[0], 255};
  }

  Orthophoto ortho;
  std::vector<unsigned char> png;
  Require(cv::imencode(".png", image, png), ErrorCode::kInternal, "OpenCV could not write the orthophoto");
  ortho.png.assign(png.begin(), png.end());
  const double pixel_size = surface.cell_size * cells_per_pixel;
  char text[256];
  std::snprintf(text, sizeof text, "%.9f\n0\n0\n%.9f\n%.9f\n%.9f\n", pixel_size, -pixel_size, (left + 0.5) * pixel_size,
                (top + 0.5) * pixel_size);
  ortho.world_file = text;
  return ortho;
}

}  // namespace parkade
