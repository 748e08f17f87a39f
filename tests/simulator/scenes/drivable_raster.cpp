#include "tests/simulator/scenes/drivable_raster.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace parkade::simulator {

DrivableRaster::DrivableRaster(const Place& place, size_t sheet_index) {
  ask_ = [sheet = place.ground.sheets()[sheet_index], is_drivable = place.is_drivable,
          sheet_index](const Eigen::Vector2d& point) {
    return sheet.Covers(point) && is_drivable(sheet_index, point);
  };
  const GroundSheet& sheet = place.ground.sheets()[sheet_index];
  min_ = sheet.min.cast<float>();
  columns_ = static_cast<int>(std::ceil((sheet.max.x() - sheet.min.x()) * kPerMeter));
  rows_ = static_cast<int>(std::ceil((sheet.max.y() - sheet.min.y()) * kPerMeter));
  cells_.resize(static_cast<size_t>(columns_) * static_cast<size_t>(rows_));
  ParallelFor(static_cast<size_t>(rows_), [&](size_t row) {
    for (int column = 0; column < columns_; ++column) {
      const Eigen::Vector2d center =
          sheet.min + Eigen::Vector2d(column + 0.5, static_cast<double>(row) + 0.5) / kPerMeter;
      cells_[row * static_cast<size_t>(columns_) + static_cast<size_t>(column)] =
          ask_(center) ? Cell::kDrivable : Cell::kUndrivable;
    }
  });
  MarkOutlines();
}

void DrivableRaster::MarkOutlines() {
  const std::vector<Cell> plain = cells_;
  ParallelFor(static_cast<size_t>(rows_), [&](size_t index) {
    const int row = static_cast<int>(index);
    for (int column = 0; column < columns_; ++column) {
      const auto at = [&](int x, int y) {
        return static_cast<size_t>(std::clamp(y, 0, rows_ - 1)) * static_cast<size_t>(columns_) +
               static_cast<size_t>(std::clamp(x, 0, columns_ - 1));
      };
      bool is_outline = row == 0 || column == 0 || row + 1 == rows_ || column + 1 == columns_;
      for (int y = row - 1; y <= row + 1; ++y)
        for (int x = column - 1; x <= column + 1; ++x)
          is_outline = is_outline || plain[at(x, y)] != plain[at(column, row)];
      if (is_outline) cells_[at(column, row)] = Cell::kOutline;
    }
  });
}

}  // namespace parkade::simulator
