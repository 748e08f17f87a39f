#pragma once

#include <cstdint>
#include <vector>

#include "tests/simulator/place.h"

namespace parkade::simulator {

/// Place::is_drivable of one sheet of the ground in steps of 5 cm, quick to ask.
class DrivableRaster {
 public:
  DrivableRaster(const Place& place, size_t sheet);

  bool At(float x, float y) const {
    const float u = (x - min_.x()) * kPerMeter, v = (y - min_.y()) * kPerMeter;
    const int column = static_cast<int>(u), row = static_cast<int>(v);
    if (u < 0 || v < 0 || column >= columns_ || row >= rows_) return false;
    return cells_[static_cast<size_t>(row) * static_cast<size_t>(columns_) + static_cast<size_t>(column)] != 0;
  }

 private:
  static constexpr float kPerMeter = 20;
  Eigen::Vector2f min_;
  int columns_, rows_;
  std::vector<std::uint8_t> cells_;
};

}  // namespace parkade::simulator
