#include "mapping/surface/join_cells.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>
#include <unordered_map>
#include <vector>

#include "core/math/fast_floor.h"

namespace parkade {
namespace {

bool IsBefore(const SurfaceCell& a, const SurfaceCell& b) {
  return std::tie(a.y, a.x, a.height) < std::tie(b.y, b.x, b.height);
}

/// Cells [begin, end) as the cell at (x, y); `capacity` cells fill it.
SurfaceCell Join(const SurfaceCell* begin, const SurfaceCell* end, int x, int y, int capacity) {
  SurfaceCell joined{.x = x, .y = y};
  std::array<int, 3> color{};
  std::array<int, kNumSurfaceClasses> classes{};
  const auto count = static_cast<int>(end - begin);
  for (const SurfaceCell* cell = begin; cell != end; ++cell) {
    joined.height += cell->height / static_cast<float>(count);
    joined.free_belief += cell->free_belief / static_cast<float>(capacity);
    joined.height_sigma = std::max(joined.height_sigma, cell->height_sigma);
    for (size_t c = 0; c < 3; ++c) color[c] += cell->color[c];
    for (size_t c = 0; c < classes.size(); ++c) classes[c] += cell->class_beliefs[c];
  }
  for (size_t c = 0; c < 3; ++c)
    joined.color[c] = static_cast<std::uint8_t>((color[c] + count / 2) / count);
  for (size_t c = 0; c < classes.size(); ++c)
    joined.class_beliefs[c] = static_cast<std::uint8_t>((classes[c] + count / 2) / count);
  return joined;
}

std::vector<SurfaceCell> JoinAll(const SurfaceMap& surface, int factor, double max_step) {
  std::vector<SurfaceCell> cells(surface.cells.begin(), surface.cells.end());
  const auto block = [&](const SurfaceCell& cell) {
    return std::pair(FloorDivide(cell.y, factor), FloorDivide(cell.x, factor));
  };
  std::sort(cells.begin(), cells.end(), [&](const SurfaceCell& a, const SurfaceCell& b) {
    return std::tuple(block(a), a.height, a.y, a.x) < std::tuple(block(b), b.height, b.y, b.x);
  });
  std::vector<SurfaceCell> joined;
  for (size_t begin = 0, end; begin < cells.size(); begin = end) {
    for (end = begin + 1;
         end < cells.size() && block(cells[end]) == block(cells[begin]) &&
         static_cast<double>(cells[end].height - cells[end - 1].height) <= max_step;)
      ++end;
    const auto [y, x] = block(cells[begin]);
    joined.push_back(Join(&cells[begin], &cells[begin] + (end - begin), x, y, factor * factor));
  }
  return joined;
}

/// Joined cells by place.
class Blocks {
 public:
  explicit Blocks(std::vector<SurfaceCell> cells) : cells_(std::move(cells)) {
    for (size_t i = 0; i < cells_.size(); ++i) at_.emplace(KeyOf(cells_[i].x, cells_[i].y), i);
  }

  const std::vector<SurfaceCell>& cells() const { return cells_; }

  /// The one at (x, y) nearest to `height`, or nothing.
  std::optional<size_t> Find(int x, int y, float height, double max_step) const {
    std::optional<size_t> nearest;
    const auto [begin, end] = at_.equal_range(KeyOf(x, y));
    for (auto i = begin; i != end; ++i) {
      const float step = std::abs(cells_[i->second].height - height);
      if (static_cast<double>(step) <= max_step &&
          (!nearest || step < std::abs(cells_[*nearest].height - height)))
        nearest = i->second;
    }
    return nearest;
  }

 private:
  static std::uint64_t KeyOf(int x, int y) {
    return (std::uint64_t{static_cast<std::uint32_t>(x)} << 32) | static_cast<std::uint32_t>(y);
  }

  std::vector<SurfaceCell> cells_;
  std::unordered_multimap<std::uint64_t, size_t> at_;
};

/// A cell that is not there, as one of its neighbors puts it.
struct Proposal {
  SurfaceCell cell;
  bool has_slope = false;  ///< continues a slope; else level
};

/// Cells of which neighbors propose several are their mean; who knows the slope goes before who
/// does not.
void AddProposed(std::vector<Proposal>& proposals, double max_step,
                 FileBackedVector<SurfaceCell>& cells) {
  std::stable_sort(proposals.begin(), proposals.end(),
                   [](const Proposal& a, const Proposal& b) { return IsBefore(a.cell, b.cell); });
  for (size_t begin = 0, end; begin < proposals.size(); begin = end) {
    SurfaceCell cell = proposals[begin].cell;
    std::array<float, 2> sums{}, counts{};
    for (end = begin; end < proposals.size() && proposals[end].cell.x == cell.x &&
                      proposals[end].cell.y == cell.y &&
                      static_cast<double>(proposals[end].cell.height - cell.height) <= max_step;
         ++end) {
      sums[proposals[end].has_slope] += proposals[end].cell.height;
      ++counts[proposals[end].has_slope];
    }
    const size_t which = counts[1] > 0 ? 1 : 0;
    cell.height = sums[which] / counts[which];
    cells.push_back(cell);
  }
}

}  // namespace

SurfaceMap JoinCells(const SurfaceMap& surface, int factor, double free_threshold,
                     double max_step) {
  const Blocks blocks(JoinAll(surface, factor, max_step));
  const std::vector<SurfaceCell>& cells = blocks.cells();
  std::vector<bool> is_kept(cells.size());
  std::vector<Proposal> proposals;
  for (size_t i = 0; i < cells.size(); ++i) {
    const SurfaceCell& cell = cells[i];
    if (static_cast<double>(cell.free_belief) < free_threshold) continue;
    is_kept[i] = true;
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        if (const std::optional<size_t> there =
                blocks.Find(cell.x + dx, cell.y + dy, cell.height, max_step)) {
          is_kept[*there] = true;
          continue;
        }
        const std::optional<size_t> opposite =
            blocks.Find(cell.x - dx, cell.y - dy, cell.height, max_step);
        Proposal beyond{cell, opposite.has_value()};
        beyond.cell.x += dx;
        beyond.cell.y += dy;
        beyond.cell.free_belief = 0;
        if (opposite) beyond.cell.height += cell.height - cells[*opposite].height;
        proposals.push_back(beyond);
      }
  }
  SurfaceMap joined{surface.cell_size * factor, {}};
  for (size_t i = 0; i < cells.size(); ++i)
    if (is_kept[i]) joined.cells.push_back(cells[i]);
  AddProposed(proposals, max_step, joined.cells);
  std::sort(joined.cells.begin(), joined.cells.end(), IsBefore);
  return joined;
}

}  // namespace parkade
