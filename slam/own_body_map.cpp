#include "slam/own_body_map.h"

#include <algorithm>

namespace parkade {
namespace {

constexpr int kCellSize = 16;         ///< [px]
constexpr double kMinTurn = 2.0;      ///< [px] a step tells something only if rotation alone would move this far
constexpr int kMinStillSteps = 8;     ///< evidence before a cell is taken for the car's body
constexpr int kMinStillPerMoved = 4;  ///< a car ahead in a curve stays still for a while, but not always
constexpr int kMaxSteps = 400;        ///< counts are halved here, so that old evidence fades

}  // namespace

OwnBodyMap::OwnBodyMap(int width, int height)
    : columns_((width + kCellSize - 1) / kCellSize),
      rows_((height + kCellSize - 1) / kCellSize),
      cells_(static_cast<size_t>(columns_ * rows_)) {}

void OwnBodyMap::Add(const Eigen::Vector2d& before, const Eigen::Vector2d& after,
                     const Eigen::Vector2d& if_fixed_to_world) {
  const double turn = (if_fixed_to_world - before).norm();
  const Cell* found = CellAt(before);
  if (turn < kMinTurn || found == nullptr) return;
  Cell& cell = cells_[static_cast<size_t>(found - cells_.data())];
  const double step = (after - before).norm();
  if (step < std::min(0.5, 0.2 * turn)) {
    ++cell.still;
  } else if (step > 0.5 * turn) {
    ++cell.moved;
  }
  if (cell.still + cell.moved > kMaxSteps) {
    cell.still /= 2;
    cell.moved /= 2;
  }
  const bool is_own_body = cell.still >= kMinStillSteps && cell.still >= kMinStillPerMoved * cell.moved;
  if (is_own_body != cell.is_own_body) ++version_;
  cell.is_own_body = is_own_body;
}

bool OwnBodyMap::IsOwnBody(const Eigen::Vector2d& pixel) const {
  const Cell* cell = CellAt(pixel);
  return cell != nullptr && cell->is_own_body;
}

cv::Mat OwnBodyMap::Exclude(const cv::Mat& usable) const {
  cv::Mat remaining = usable.clone();
  const cv::Rect image(0, 0, usable.cols, usable.rows);
  for (int row = 0; row < rows_; ++row)
    for (int column = 0; column < columns_; ++column)
      if (cells_[static_cast<size_t>(row * columns_ + column)].is_own_body)
        remaining(cv::Rect(column * kCellSize, row * kCellSize, kCellSize, kCellSize) & image) = 0;
  return remaining;
}

const OwnBodyMap::Cell* OwnBodyMap::CellAt(const Eigen::Vector2d& pixel) const {
  const int column = static_cast<int>(pixel.x()) / kCellSize;
  const int row = static_cast<int>(pixel.y()) / kCellSize;
  if (pixel.minCoeff() < 0 || column >= columns_ || row >= rows_) return nullptr;
  return &cells_[static_cast<size_t>(row * columns_ + column)];
}

}  // namespace parkade
