#pragma once

#include <algorithm>
#include <tuple>
#include <utility>
#include <vector>

#include "core/parallel.h"

namespace parkade {

/// Sorts what has a `cell` as the cells of a SurfaceMap are: by y, then x, then height. In
/// parallel, row by row.
template <typename HasCell>
void SortCells(std::vector<HasCell>& cells) {
  if (cells.empty()) return;
  const auto is_lower = [](const HasCell& a, const HasCell& b) { return a.cell.y < b.cell.y; };
  const auto [lowest, highest] = std::minmax_element(cells.begin(), cells.end(), is_lower);
  const int low = lowest->cell.y;
  std::vector<std::size_t> ends(static_cast<std::size_t>(highest->cell.y - low) + 1);  // of rows
  for (const HasCell& at : cells) ++ends[static_cast<std::size_t>(at.cell.y - low)];
  std::size_t sum = 0;
  for (std::size_t& end : ends) sum += std::exchange(end, sum);
  std::vector<HasCell> sorted(cells.size());
  for (const HasCell& at : cells) sorted[ends[static_cast<std::size_t>(at.cell.y - low)]++] = at;
  ParallelFor(ends.size(), [&](std::size_t row) {
    const auto begin = sorted.begin() + static_cast<std::ptrdiff_t>(row == 0 ? 0 : ends[row - 1]);
    std::sort(begin, sorted.begin() + static_cast<std::ptrdiff_t>(ends[row]),
              [](const HasCell& a, const HasCell& b) {
                return std::tie(a.cell.x, a.cell.height) < std::tie(b.cell.x, b.cell.height);
              });
  });
  cells = std::move(sorted);
}

}  // namespace parkade
