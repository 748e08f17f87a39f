#include "slam/tracking/ego_mask.h"

#include <algorithm>
#include <set>

namespace parkade {
namespace {

constexpr int kCellSize = 16;       ///< [px]
constexpr double kPatchRadius = 8;  ///< [px] what a track shows around its pixel
constexpr double kMinTurn =
    2.0;  ///< [px] a step tells something only if rotation alone would move this far
constexpr int kMinStillSteps = 8;  ///< evidence before a cell is taken for the car's body
constexpr int kMinStillPerMoved =
    4;                          ///< a car ahead in a curve stays still for a while, but not always
constexpr int kMaxSteps = 400;  ///< counts are halved here, so that old evidence fades

}  // namespace

EgoMask::EgoMask(int width, int height)
    : columns_((width + kCellSize - 1) / kCellSize),
      rows_((height + kCellSize - 1) / kCellSize),
      cells_(static_cast<size_t>(columns_ * rows_)) {}

void EgoMask::Add(const Eigen::Vector2d& before, const Eigen::Vector2d& after,
                  const Eigen::Vector2d& if_fixed_to_world) {
  const double turn = (if_fixed_to_world - before).norm();
  if (turn < kMinTurn) return;
  const double step = (after - before).norm();
  const bool is_still = step<std::min(0.5, 0.2 * turn), has_moved = step> 0.5 * turn;
  std::set<size_t> touched;
  for (const double dy : {-kPatchRadius, kPatchRadius})
    for (const double dx : {-kPatchRadius, kPatchRadius})
      if (const auto cell = CellAt(before + Eigen::Vector2d(dx, dy))) touched.insert(*cell);
  for (const size_t index : touched) {
    Cell& cell = cells_[index];
    cell.still += is_still;
    cell.moved += has_moved;
    if (cell.still + cell.moved > kMaxSteps) {
      cell.still /= 2;
      cell.moved /= 2;
    }
    const bool is_ego =
        cell.still >= kMinStillSteps && cell.still >= kMinStillPerMoved * cell.moved;
    if (is_ego != cell.is_ego) ++version_;
    cell.is_ego = is_ego;
  }
}

bool EgoMask::IsEgoVehicle(const Eigen::Vector2d& pixel) const {
  const std::optional<size_t> cell = CellAt(pixel);
  return cell && cells_[*cell].is_ego;
}

cv::Mat EgoMask::Exclude(const cv::Mat& usable) const {
  cv::Mat remaining = usable.clone();
  const cv::Rect image(0, 0, usable.cols, usable.rows);
  for (int row = 0; row < rows_; ++row)
    for (int column = 0; column < columns_; ++column)
      if (cells_[static_cast<size_t>(row * columns_ + column)].is_ego)
        remaining(cv::Rect(column * kCellSize, row * kCellSize, kCellSize, kCellSize) & image) = 0;
  return remaining;
}

std::optional<size_t> EgoMask::CellAt(const Eigen::Vector2d& pixel) const {
  if (!(pixel.minCoeff() >= 0 && pixel.x() < columns_ * kCellSize && pixel.y() < rows_ * kCellSize))
    return std::nullopt;
  return static_cast<size_t>(static_cast<int>(pixel.y()) / kCellSize * columns_ +
                             static_cast<int>(pixel.x()) / kCellSize);
}

}  // namespace parkade
