#include "mapping/markings/ground_tiles.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

#include "mapping/ground/surface_window.h"

namespace parkade {
namespace {

double MeanHeight(const TriangleMesh& mesh, const TextureChart& chart) {
  double sum = 0;
  for (const std::uint32_t triangle : chart.triangles)
    for (const std::uint32_t vertex : mesh.triangles[triangle])
      sum += static_cast<double>(mesh.vertices[vertex].z());
  return mesh.origin.z() + sum / std::max(1.0, 3 * static_cast<double>(chart.triangles.size()));
}

/// Copies what `chart` knows into pixels of `tile` that are still empty.
void Fill(const TextureChart& chart, GroundTile& tile) {
  const int column = static_cast<int>(std::lround((chart.left - tile.left) / tile.pixel_size));
  const int row = static_cast<int>(std::lround((tile.top - chart.top) / tile.pixel_size));
  const cv::Rect in_tile = cv::Rect(column, row, chart.image.cols, chart.image.rows) &
                           cv::Rect(0, 0, tile.image.cols, tile.image.rows);
  if (in_tile.empty()) return;
  const cv::Rect in_chart = in_tile - cv::Point(column, row);
  const cv::Mat mask_of_chart = chart.mask(in_chart);
  cv::Mat mask_of_tile = tile.mask(in_tile);
  const cv::Mat is_new = (mask_of_tile == 0) & (mask_of_chart != 0);
  const cv::Mat is_painted = is_new & (mask_of_chart == TextureChart::kPainted);
  chart.image(in_chart).copyTo(tile.image(in_tile), is_new);
  mask_of_tile.setTo(GroundTile::kUnsure, is_new);
  mask_of_tile.setTo(GroundTile::kSure, is_painted);
}

}  // namespace

GroundTiles::GroundTiles(const TriangleMesh& mesh, const SurfaceMap& surface,
                         const GroundTexture& texture, double margin, double max_step)
    : surface_(&surface), texture_(&texture), margin_(margin), max_step_(max_step) {
  for (const TextureChart& chart : texture.charts) heights_.push_back(MeanHeight(mesh, chart));
  for (std::size_t i = 0; i < texture.charts.size(); ++i) {
    const TextureChart& chart = texture.charts[i];
    const bool is_in_tile = std::any_of(leaders_.begin(), leaders_.end(), [&](std::size_t leader) {
      const TextureChart& other = texture.charts[leader];
      return other.column == chart.column && other.row == chart.row && IsOfDeck(i, leader);
    });
    if (!is_in_tile) leaders_.push_back(i);
  }
}

GroundTile GroundTiles::Make(std::size_t index) const {
  const std::size_t leader = leaders_[index];
  const TextureChart& chart = texture_->charts[leader];
  const double texel = texture_->texel_size, size = texture_->chart_size;
  const auto texels = [texel](double length) {
    return static_cast<int>(std::lround(length / texel));
  };
  GroundTile tile;
  tile.pixel_size = texel;
  tile.height = heights_[leader];
  const Eigen::Vector2d corner(chart.column * size, chart.row * size);
  tile.core = Eigen::AlignedBox2d(corner, Eigen::Vector2d(corner.array() + size));
  tile.left = texel * texels(corner.x() - margin_);
  tile.top = texel * texels(corner.y() + size + margin_);
  const int side = texels(size + 2 * margin_);
  tile.image = cv::Mat(side, side, CV_8UC3, cv::Scalar::all(0));
  tile.mask = cv::Mat(side, side, CV_8UC1, cv::Scalar::all(0));
  Fill(chart, tile);

  std::vector<std::pair<double, std::size_t>> others;  // the most alike in height first
  for (std::size_t i = 0; i < texture_->charts.size(); ++i) {
    const TextureChart& other = texture_->charts[i];
    if (i != leader && IsOfDeck(i, leader) && std::abs(other.column - chart.column) <= 1 &&
        std::abs(other.row - chart.row) <= 1)
      others.emplace_back(std::abs(heights_[i] - heights_[leader]), i);
  }
  std::sort(others.begin(), others.end());
  for (const auto& [step, i] : others) Fill(texture_->charts[i], tile);
  AddCells(tile);
  texture_->Release();
  return tile;
}

void GroundTiles::AddCells(GroundTile& tile) const {
  const double size = surface_->cell_size;
  const int side = static_cast<int>(std::ceil(size / tile.pixel_size));
  const cv::Rect whole(0, 0, tile.image.cols, tile.image.rows);
  const auto first = [size](double coordinate) {
    return static_cast<int>(std::floor(coordinate / size));
  };
  const Eigen::AlignedBox2i window(
      Eigen::Vector2i(first(tile.left) - 1, first(tile.top - tile.image.rows * tile.pixel_size)),
      Eigen::Vector2i(first(tile.left + tile.image.cols * tile.pixel_size) + 2,
                      first(tile.top) + 1));
  const auto add = [&](const SurfaceCell& cell) {
    if (cell.y * size >= tile.top ||
        std::abs(static_cast<double>(cell.height) - tile.height) > max_step_)
      return;
    const int column = static_cast<int>(std::lround((cell.x * size - tile.left) / tile.pixel_size));
    const int row =
        static_cast<int>(std::lround((tile.top - (cell.y + 1) * size) / tile.pixel_size));
    const cv::Rect square = cv::Rect(column, row, side, side) & whole;
    for (int y = square.y; y < square.y + square.height; ++y)
      for (int x = square.x; x < square.x + square.width; ++x) {
        std::uint8_t& mask = tile.mask.at<std::uint8_t>(y, x);
        if (mask == GroundTile::kSure) continue;
        mask = GroundTile::kUnsure;
        tile.image.at<cv::Vec3b>(y, x) = {cell.color[2], cell.color[1], cell.color[0]};
      }
  };
  VisitRows(*surface_, window, [&](std::span<const SurfaceCell> cells) {
    std::for_each(cells.begin(), cells.end(), add);
  });
}

}  // namespace parkade
