#include "tests/simulator/drivable_raster.h"

#include "core/parallel.h"

namespace parkade::simulator {

DrivableRaster::DrivableRaster(const Place& place, size_t sheet_index) {
  const GroundSheet& sheet = place.ground.sheets()[sheet_index];
  min_ = sheet.min.cast<float>();
  columns_ = static_cast<int>((sheet.max.x() - sheet.min.x()) * kPerMeter);
  rows_ = static_cast<int>((sheet.max.y() - sheet.min.y()) * kPerMeter);
  cells_.resize(static_cast<size_t>(columns_) * static_cast<size_t>(rows_));
  ParallelFor(static_cast<size_t>(rows_), [&](size_t row) {
    for (int column = 0; column < columns_; ++column) {
      const Eigen::Vector2d center =
          sheet.min + Eigen::Vector2d(column + 0.5, static_cast<double>(row) + 0.5) / kPerMeter;
      cells_[row * static_cast<size_t>(columns_) + static_cast<size_t>(column)] =
          sheet.Covers(center) && place.is_drivable(sheet_index, center);
    }
  });
}

}  // namespace parkade::simulator
