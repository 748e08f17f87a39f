#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "tests/simulator/layouts/place.h"

namespace parkade::simulator {

/// Place::is_drivable of one sheet of the ground, quick to ask: looked up in cells of 5 cm, and
/// asked for anew where neighboring cells differ, so that outlines are exact.
class DrivableRaster {
 public:
  DrivableRaster(const Place& place, size_t sheet);

  bool At(float x, float y) const {
    const float u = (x - min_.x()) * kPerMeter, v = (y - min_.y()) * kPerMeter;
    const int column = static_cast<int>(u), row = static_cast<int>(v);
    if (u < 0 || v < 0 || column >= columns_ || row >= rows_) return false;
    const Cell cell = cells_[static_cast<size_t>(row) * static_cast<size_t>(columns_) +
                             static_cast<size_t>(column)];
    return cell == Cell::kOutline ? ask_({x, y}) : cell == Cell::kDrivable;
  }

 private:
  enum class Cell : std::uint8_t { kUndrivable, kDrivable, kOutline };
  void MarkOutlines();

  static constexpr float kPerMeter = 20;
  Eigen::Vector2f min_;
  int columns_, rows_;
  std::vector<Cell> cells_;
  std::function<bool(const Eigen::Vector2d&)> ask_;
};

}  // namespace parkade::simulator
