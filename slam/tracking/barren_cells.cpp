#include "slam/tracking/barren_cells.h"

#include <algorithm>

namespace parkade {
namespace {

constexpr float kNewest = 0.2f;  ///< weight of the latest track of a cell
constexpr float kMinSurvival = 0.3f;
constexpr std::int64_t kImagesPerTry = 4;

}  // namespace

BarrenCells::BarrenCells(int width, int height, int cell_size)
    : cell_size_(cell_size),
      columns_((width + cell_size - 1) / cell_size),
      rows_((height + cell_size - 1) / cell_size),
      survival_(static_cast<size_t>(columns_ * rows_), 1.0f) {}

size_t BarrenCells::CellOf(const Eigen::Vector2d& pixel) const {
  const int column = std::clamp(static_cast<int>(pixel.x()) / cell_size_, 0, columns_ - 1);
  const int row = std::clamp(static_cast<int>(pixel.y()) / cell_size_, 0, rows_ - 1);
  return static_cast<size_t>(row * columns_ + column);
}

void BarrenCells::Note(const Eigen::Vector2d& pixel, bool was_found) {
  float& survival = survival_[CellOf(pixel)];
  survival += kNewest * ((was_found ? 1.0f : 0.0f) - survival);
}

bool BarrenCells::Rests(const Eigen::Vector2d& pixel, std::int64_t image) const {
  const size_t cell = CellOf(pixel);
  // Cells take turns, so that each image tries some.
  return survival_[cell] < kMinSurvival &&
         (image + static_cast<std::int64_t>(cell)) % kImagesPerTry != 0;
}

}  // namespace parkade
