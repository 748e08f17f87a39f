#pragma once

#include <cstdint>
#include <vector>

#include "tests/simulator/lot_layout.h"

namespace parkade::simulator {

/// LotLayout::IsDrivable in steps of 5 cm, quick to ask.
class DrivableRaster {
 public:
  explicit DrivableRaster(const LotLayout& layout);

  bool At(float x, float y) const {
    const int column = static_cast<int>(x * kPerMeter), row = static_cast<int>(y * kPerMeter);
    if (x < 0 || y < 0 || column >= columns_ || row >= rows_) return false;
    return cells_[static_cast<size_t>(row) * static_cast<size_t>(columns_) + static_cast<size_t>(column)] != 0;
  }

 private:
  static constexpr float kPerMeter = 20;
  int columns_, rows_;
  std::vector<std::uint8_t> cells_;
};

}  // namespace parkade::simulator
