#include "mapping/surface/free_clearance.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace parkade {
namespace {

constexpr int kMaxRadius = 254;

/// The radii of a row of cells, 0 where none is.
class RadiusRow {
 public:
  void Begin(int first_x, int last_x) {
    first_x_ = first_x;
    radii_.assign(static_cast<std::size_t>(last_x - first_x) + 1, 0);
  }
  std::uint8_t& At(int x) { return radii_[static_cast<std::size_t>(x - first_x_)]; }
  /// The least of a place and those beside it.
  int LeastAround(int x) const { return std::min({Of(x - 1), Of(x), Of(x + 1)}); }
  int Of(int x) const {
    const std::ptrdiff_t i = std::ptrdiff_t{x} - first_x_;
    return i >= 0 && i < std::ssize(radii_) ? radii_[static_cast<std::size_t>(i)] : 0;
  }

 private:
  int first_x_ = 0;
  std::vector<std::uint8_t> radii_;
};

/// One pass of the chessboard distance transform (A. Rosenfeld, J. Pfaltz, "Distance functions on
/// digital pictures", Pattern Recognition 1, 1968), forward or backward over all cells: `visit` of
/// a cell's index and the least radius of its neighbors that were passed gives its radius.
template <typename Visit>
void PassOver(const FileBackedVector<SurfaceCell>& cells, bool is_backward, const Visit& visit) {
  RadiusRow row, before;
  int row_y = 0;
  const std::size_t count = cells.size();
  const auto index_of = [&](std::size_t i) { return is_backward ? count - 1 - i : i; };
  const int step = is_backward ? -1 : 1;
  std::size_t released = 0;
  for (std::size_t begin = 0, end; begin < count; begin = end) {
    const int y = cells[index_of(begin)].y;
    for (end = begin; end < count && cells[index_of(end)].y == y;) ++end;
    const auto [first_x, last_x] =
        std::minmax(cells[index_of(begin)].x, cells[index_of(end - 1)].x);
    std::swap(row, before);
    if (begin == 0 || row_y + step != y) before.Begin(0, -1);
    row.Begin(first_x, last_x);
    row_y = y;
    for (std::size_t i = begin; i < end; ++i) {
      const int x = cells[index_of(i)].x;
      row.At(x) = visit(index_of(i), std::min(before.LeastAround(x), row.Of(x - step)));
    }
    if ((end - released) * sizeof(SurfaceCell) < kMinScratchBytes) continue;
    ReleaseMemory(cells);
    released = end;
  }
}

}  // namespace

FreeClearance::FreeClearance(const CellFinder& cells)
    : cells_(&cells), radii_(cells.surface().cells.size()) {
  const FileBackedVector<SurfaceCell>& all = cells.surface().cells;
  const auto is_alone = [&](std::size_t i) {
    const auto shares = [&](const SurfaceCell& other) {
      return other.x == all[i].x && other.y == all[i].y;
    };
    return (i == 0 || !shares(all[i - 1])) && (i + 1 == all.size() || !shares(all[i + 1]));
  };
  const auto one_more = [](int radius) {
    return static_cast<std::uint8_t>(std::min(radius, kMaxRadius) + 1);
  };
  PassOver(all, false, [&](std::size_t i, int least) {
    radii_[i] = all[i].free_belief > 0.5F && is_alone(i) ? one_more(least) : 0;
    return radii_[i];
  });
  PassOver(all, true, [&](std::size_t i, int least) {
    radii_[i] = std::min(radii_[i], one_more(least));
    return radii_[i];
  });
}

int FreeClearance::Around(const SurfaceCell& cell) const {
  const auto index = static_cast<std::size_t>(&cell - cells_->surface().cells.data());
  return std::max(0, radii_[index] - 1);
}

double FreeClearance::Around(const Eigen::Vector2d& place, const SurfaceCell& cell) const {
  const double size = cells_->surface().cell_size;
  const auto is_at = [size](double at, int index) { return std::floor(at / size) == index; };
  return is_at(place.x(), cell.x) && is_at(place.y(), cell.y) ? Around(cell) * size : 0;
}

}  // namespace parkade
