#include "tests/simulator/drivable_raster.h"

#include "core/parallel.h"

namespace parkade::simulator {

DrivableRaster::DrivableRaster(const LotLayout& layout)
    : columns_(static_cast<int>(layout.length * kPerMeter)), rows_(static_cast<int>(layout.width * kPerMeter)) {
  cells_.resize(static_cast<size_t>(columns_) * static_cast<size_t>(rows_));
  ParallelFor(static_cast<size_t>(rows_), [&](size_t row) {
    for (int column = 0; column < columns_; ++column) {
      const Eigen::Vector2d center((column + 0.5) / kPerMeter, (static_cast<double>(row) + 0.5) / kPerMeter);
      cells_[row * static_cast<size_t>(columns_) + static_cast<size_t>(column)] = layout.IsDrivable(center);
    }
  });
}

}  // namespace parkade::simulator
