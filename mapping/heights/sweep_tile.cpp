#include "mapping/heights/sweep_tile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "core/parallel.h"

namespace parkade {
namespace {

constexpr std::size_t kChunk = 512;  // observations whose cells are found at once

/// Rounded down, at least 0 and at most `limit`.
float WholeBelow(float value, float limit) {
  return static_cast<float>(static_cast<std::int32_t>(std::min(std::max(0.0F, value), limit)));
}

/// Where observations lie, and how they move with height [cells].
struct Places {
  const float *x, *y, *dx, *dy;
};

/// The cells of a grid, `across` to each side, that observations fall into at one height.
void FindCells(const Places& places, float offset, int across, std::span<std::int32_t> cells) {
  const auto [x, y, dx, dy] = places;
  const auto row_length = static_cast<float>(across), limit = row_length - 1;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const float column = WholeBelow(x[i] + offset * dx[i] + 1, limit),
                row = WholeBelow(y[i] + offset * dy[i] + 1, limit);
    cells[i] = static_cast<std::int32_t>(row * row_length + column);
  }
}

}  // namespace

TileSweep::TileSweep(SweepShape shape) : shape_(std::move(shape)), per_cell_(1 / shape_.cell_size) {
  const int fine = NumCells(1), coarse = NumCells(2);
  coarse_of_.reserve(static_cast<std::size_t>(fine) * static_cast<std::size_t>(fine));
  for (int row = 0; row < fine; ++row)
    for (int column = 0; column < fine; ++column)
      coarse_of_.push_back((row + 1) / 2 * coarse + (column + 1) / 2);
}

std::vector<Agreement> TileSweep::SweepTwice(std::vector<Agreement>* coarse) const {
  std::vector<Agreement> agreements(
      static_cast<std::size_t>(shape_.num_windows * shape_.num_windows) * shape_.offsets.size());
  if (coarse) coarse->assign(agreements.size(), {});
  ParallelFor(shape_.offsets.size(), [&](std::size_t height) {
    Grid fine(NumCells(1));
    std::optional<Grid> twice;
    if (coarse) twice.emplace(NumCells(2));
    AddUp(shape_.offsets[height], fine, twice ? &*twice : nullptr);
    AgreementsOf(fine, 1, height, agreements);
    if (twice) AgreementsOf(*twice, 2, height, *coarse);
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

TileSweep::Grid::Grid(int across)
    : across_(across),
      cells_(static_cast<std::size_t>(across) * static_cast<std::size_t>(across)),
      of_view_(cells_.size()),
      seen_(cells_.size() + 1) {}

void TileSweep::Grid::Add(std::span<const std::int32_t> cells, const Sample* samples) {
  std::size_t num_seen = num_seen_;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    Sample& sum = of_view_[static_cast<std::size_t>(cells[i])];
    seen_[num_seen] = cells[i];
    num_seen += sum.weight == 0;
    sum.weight += samples[i].weight, sum.gray += samples[i].gray;
  }
  num_seen_ = num_seen;
}

void TileSweep::Grid::EndView() {
  for (std::size_t i = 0; i < num_seen_; ++i) {
    const auto cell = static_cast<std::size_t>(seen_[i]);
    cells_[cell].Add(std::exchange(of_view_[cell], {}));
  }
  num_seen_ = 0;
}

void TileSweep::Grid::EndView(std::span<const std::int32_t> coarse_of, Grid& coarse) {
  sums_.resize(num_seen_);
  for (std::size_t i = 0; i < num_seen_; ++i) {
    const auto cell = static_cast<std::size_t>(seen_[i]);
    sums_[i] = of_view_[cell];
    seen_[i] = coarse_of[cell];
    cells_[cell].Add(std::exchange(of_view_[cell], {}));
  }
  coarse.Add({seen_.data(), num_seen_}, sums_.data());
  coarse.EndView();
  num_seen_ = 0;
}

void TileSweep::AddUp(float offset, Grid& fine, Grid* coarse) const {
  std::array<std::int32_t, kChunk> at;
  for (std::size_t view = 0; view < views_.size(); ++view) {
    const std::size_t end = view + 1 < views_.size() ? views_[view + 1] : x_.size();
    for (std::size_t begin = views_[view]; begin < end; begin += kChunk) {
      const std::size_t count = std::min(kChunk, end - begin);
      FindCells({&x_[begin], &y_[begin], &dx_[begin], &dy_[begin]}, offset, fine.across(),
                {at.data(), count});
      fine.Add({at.data(), count}, &samples_[begin]);
    }
    if (coarse)
      fine.EndView(coarse_of_, *coarse);
    else
      fine.EndView();
  }
}

void TileSweep::AgreementsOf(const Grid& grid, int cells_in_one, std::size_t height,
                             std::vector<Agreement>& agreements) const {
  const int across = grid.across() - 2, per_window = shape_.cells_per_window / cells_in_one;
  for (int y = 0; y < across; ++y)
    for (int x = 0; x < across; ++x) {
      const Cell& cell = grid.At(x + 1, y + 1);
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
