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
    : shape_(std::move(shape)), per_cell_(1 / shape_.cell_size) {}

std::vector<Agreement> TileSweep::SweepTwice(std::vector<Agreement>* coarse) const {
  std::vector<Agreement> agreements(
      static_cast<std::size_t>(shape_.num_windows * shape_.num_windows) * shape_.offsets.size());
  if (coarse) coarse->assign(agreements.size(), {});
  ParallelFor(shape_.offsets.size(), [&](std::size_t height) {
    AgreementsInto(height, 1, agreements);
    if (coarse) AgreementsInto(height, 2, *coarse);
  });
  return agreements;
}

std::vector<float> TileSweep::Parallaxes() const {
  std::vector<Eigen::Array4f> sums(
      static_cast<std::size_t>(shape_.num_windows * shape_.num_windows), Eigen::Array4f::Zero());
  const auto side = static_cast<float>(shape_.num_windows),
             per_window = 1 / static_cast<float>(shape_.cells_per_window);
  for (std::size_t i = 0; i < x_.size(); ++i) {
    const float x = x_[i] * per_window, y = y_[i] * per_window;
    if (x < 0 || y < 0 || x >= side || y >= side) continue;
    const auto window =
        static_cast<std::size_t>(static_cast<int>(y) * shape_.num_windows + static_cast<int>(x));
    const float dx = dx_[i] / per_cell_, dy = dy_[i] / per_cell_;
    sums[window] += Eigen::Array4f(1, dx, dy, dx * dx + dy * dy);
  }
  std::vector<float> parallaxes;
  for (const Eigen::Array4f& sum : sums) {
    const Eigen::Array3f mean = sum.tail<3>() / std::max(sum[0], 1.0F);
    parallaxes.push_back(
        std::sqrt(std::max(mean[2] - mean[0] * mean[0] - mean[1] * mean[1], 0.0F)));
  }
  return parallaxes;
}

void TileSweep::Cell::Add(const Sample& of_view) {
  all.weight += of_view.weight, all.gray += of_view.gray;
  square += of_view.gray * of_view.gray / of_view.weight;
  ++num_views;
}

/// Row by row, with a rim of one that gathers what lies outside.
std::vector<TileSweep::Cell> TileSweep::AddUp(float offset, int cells_in_one) const {
  const int across = NumCells(cells_in_one) + 2;
  std::vector<Cell> cells(static_cast<std::size_t>(across) * static_cast<std::size_t>(across));
  // What the view at hand says lies apart and close together: it is touched most often.
  std::vector<Sample> of_view(cells.size());
  std::vector<std::int32_t> seen(cells.size() + 1);
  std::array<std::int32_t, kChunk> at;
  const auto limit = static_cast<float>(across - 1);
  const float scale = 1 / static_cast<float>(cells_in_one);
  for (std::size_t view = 0; view < views_.size(); ++view) {
    const std::size_t end = view + 1 < views_.size() ? views_[view + 1] : x_.size();
    std::size_t num_seen = 0;
    for (std::size_t begin = views_[view]; begin < end; begin += kChunk) {
      const std::size_t count = std::min(kChunk, end - begin);
      const float *x = &x_[begin], *y = &y_[begin], *dx = &dx_[begin], *dy = &dy_[begin];
      for (std::size_t i = 0; i < count; ++i) {
        const auto column =
            static_cast<std::int32_t>(Clamped(scale * (x[i] + offset * dx[i]) + 1, limit));
        const auto row =
            static_cast<std::int32_t>(Clamped(scale * (y[i] + offset * dy[i]) + 1, limit));
        at[i] = row * across + column;
      }
      const Sample* samples = &samples_[begin];
      for (std::size_t i = 0; i < count; ++i) {
        Sample& sum = of_view[static_cast<std::size_t>(at[i])];
        seen[num_seen] = at[i];
        num_seen += sum.weight == 0;  // weights are greater
        sum.weight += samples[i].weight, sum.gray += samples[i].gray;
      }
    }
    for (std::size_t i = 0; i < num_seen; ++i) {
      const auto cell = static_cast<std::size_t>(seen[i]);
      cells[cell].Add(std::exchange(of_view[cell], {}));
    }
  }
  return cells;
}

void TileSweep::AgreementsInto(std::size_t height, int cells_in_one,
                               std::vector<Agreement>& agreements) const {
  const int across = NumCells(cells_in_one), per_window = shape_.cells_per_window / cells_in_one;
  const std::vector<Cell> cells = AddUp(shape_.offsets[height], cells_in_one);
  for (int y = 0; y < across; ++y)
    for (int x = 0; x < across; ++x) {
      const Cell& cell = cells[static_cast<std::size_t>((y + 1) * (across + 2) + x + 1)];
      if (cell.num_views == 0) continue;
      const auto window =
          static_cast<std::size_t>(y / per_window * shape_.num_windows + x / per_window);
      Agreement& agreement = agreements[window * shape_.offsets.size() + height];
      agreement.residual += cell.square - cell.all.gray * cell.all.gray / cell.all.weight;
      agreement.total += cell.square;
      agreement.weight += cell.all.weight;
      agreement.num_samples += cell.num_views;
      ++agreement.num_cells;
    }
}

}  // namespace parkade
