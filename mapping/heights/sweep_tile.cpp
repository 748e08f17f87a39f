#include "mapping/heights/sweep_tile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/parallel.h"

namespace parkade {
namespace {

constexpr std::size_t kChunk = 512;  // observations whose cells are found at once

float Clamped(float value, float limit) {
  value = value > 0 ? value : 0;
  return value < limit ? value : limit;
}

}  // namespace

TileSweep::TileSweep(SweepShape shape)
    : shape_(std::move(shape)),
      per_cell_(1 / shape_.cell_size),
      across_(shape_.num_windows * shape_.cells_per_window + 2) {}

std::vector<Agreement> TileSweep::SweepTwice(std::vector<Agreement>* coarse) const {
  std::vector<Agreement> agreements(
      static_cast<std::size_t>(shape_.num_windows * shape_.num_windows) * shape_.offsets.size());
  if (coarse) coarse->assign(agreements.size(), {});
  ParallelFor(shape_.offsets.size(), [&](std::size_t height) {
    const std::vector<Sums> cells = AddUp(shape_.offsets[height]);
    AgreementsInto(height, cells, 1, agreements);
    if (coarse) AgreementsInto(height, cells, 2, *coarse);
  });
  return agreements;
}

std::vector<float> TileSweep::Parallaxes() const {
  std::vector<Sums> sums(static_cast<std::size_t>(shape_.num_windows * shape_.num_windows),
                         Sums::Zero());
  const auto side = static_cast<float>(shape_.num_windows),
             per_window = 1 / static_cast<float>(shape_.cells_per_window);
  for (std::size_t i = 0; i < x_.size(); ++i) {
    const float x = (x_[i] - 1) * per_window, y = (y_[i] - 1) * per_window;
    if (x < 0 || y < 0 || x >= side || y >= side) continue;
    const auto window =
        static_cast<std::size_t>(static_cast<int>(y) * shape_.num_windows + static_cast<int>(x));
    const float dx = dx_[i] / per_cell_, dy = dy_[i] / per_cell_;
    sums[window] += Sums(1, dx, dy, dx * dx + dy * dy);
  }
  std::vector<float> parallaxes;
  for (const Sums& sum : sums) {
    const Eigen::Array3f mean = sum.tail<3>() / std::max(sum[0], 1.0F);
    parallaxes.push_back(
        std::sqrt(std::max(mean[2] - mean[0] * mean[0] - mean[1] * mean[1], 0.0F)));
  }
  return parallaxes;
}

std::vector<TileSweep::Sums> TileSweep::AddUp(float offset) const {
  std::vector<Sums> cells(static_cast<std::size_t>(across_) * static_cast<std::size_t>(across_),
                          Sums::Zero());
  std::array<std::int32_t, kChunk> at;
  const auto limit = static_cast<float>(across_ - 1);
  for (std::size_t begin = 0; begin < x_.size(); begin += kChunk) {
    const std::size_t count = std::min(kChunk, x_.size() - begin);
    const float *x = &x_[begin], *y = &y_[begin], *dx = &dx_[begin], *dy = &dy_[begin];
    for (std::size_t i = 0; i < count; ++i) {
      const auto column = static_cast<std::int32_t>(Clamped(x[i] + offset * dx[i], limit));
      const auto row = static_cast<std::int32_t>(Clamped(y[i] + offset * dy[i], limit));
      at[i] = row * across_ + column;
    }
    const Sums* sums = &sums_[begin];
    for (std::size_t i = 0; i < count; ++i) cells[static_cast<std::size_t>(at[i])] += sums[i];
  }
  return cells;
}

void TileSweep::AgreementsInto(std::size_t height, const std::vector<Sums>& cells, int cells_in_one,
                               std::vector<Agreement>& agreements) const {
  const auto at = [&](int x, int y) {
    return cells[static_cast<std::size_t>((y + 1) * across_ + x + 1)];
  };
  for (int y = 0; y + 2 < across_; y += cells_in_one)
    for (int x = 0; x + 2 < across_; x += cells_in_one) {
      Sums cell = at(x, y);
      if (cells_in_one == 2) cell += at(x + 1, y) + at(x, y + 1) + at(x + 1, y + 1);
      if (cell[3] == 0) continue;
      const auto window = static_cast<std::size_t>(
          y / shape_.cells_per_window * shape_.num_windows + x / shape_.cells_per_window);
      Agreement& agreement = agreements[window * shape_.offsets.size() + height];
      agreement.residual += cell[2] - cell[1] * cell[1] / cell[0];
      agreement.total += cell[2];
      agreement.weight += cell[0];
      agreement.num_samples += static_cast<int>(cell[3]);
      ++agreement.num_cells;
    }
}

}  // namespace parkade
