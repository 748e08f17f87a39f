#include "mapping/surface/free_islands.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "mapping/ground/surface_links.h"

namespace parkade {
namespace {

using PaintedCell = SurfacePainter::PaintedCell;

constexpr double kMaxStep = 0.1;

/// Random ground of which some is free, with a deck above a part of it, and a few driven cells.
std::vector<PaintedCell> MakeGround(unsigned seed) {
  std::mt19937 random(seed);
  std::vector<PaintedCell> cells;
  for (int y = -20; y < 25; ++y)
    for (int x = 0; x < 40; ++x) {
      if (y == 7 || random() % 10 == 0) continue;
      PaintedCell cell;
      cell.cell = {.x = x, .y = y, .height = 0.06F * static_cast<float>(random() % 3)};
      for (const bool is_upper : {false, true}) {
        if (is_upper && x < 20) continue;
        cell.cell.height += is_upper ? 3.0F : 0.0F;
        cell.cell.free_belief = random() % 5 < 3 ? 0.9F : 0.1F;
        cell.is_seen = random() % 20 != 0;
        cell.is_driven = random() % 300 == 0;
        cells.push_back(cell);
      }
    }
  return cells;
}

/// For each cell whether its island is small, all cells being there at once.
std::vector<bool> FindSmallByFlooding(const std::vector<PaintedCell>& cells, double min_cells) {
  SurfaceMap surface;
  for (const PaintedCell& cell : cells) surface.cells.push_back(cell.cell);
  const SurfaceLinks links = LinkCells(surface, kMaxStep);
  const auto is_free = [&](size_t i) {
    return cells[i].is_seen && cells[i].cell.free_belief > 0.5F;
  };
  std::vector<bool> is_small(cells.size()), is_found(cells.size());
  for (size_t seed = 0; seed < cells.size(); ++seed) {
    if (!is_free(seed) || is_found[seed]) continue;
    std::vector<size_t> island{seed};
    is_found[seed] = true;
    bool is_driven = false;
    for (size_t k = 0; k < island.size(); ++k) {
      is_driven = is_driven || cells[island[k]].is_driven;
      for (const auto* next : {&links.left, &links.right, &links.up, &links.down}) {
        const int other = (*next)[island[k]];
        if (other < 0 || !is_free(static_cast<size_t>(other)) ||
            is_found[static_cast<size_t>(other)])
          continue;
        is_found[static_cast<size_t>(other)] = true;
        island.push_back(static_cast<size_t>(other));
      }
    }
    for (const size_t i : island)
      is_small[i] = !is_driven && static_cast<double>(island.size()) < min_cells;
  }
  return is_small;
}

TEST(FreeIslands, AreTheSameHoweverManyRowsComeAtOnce) {
  constexpr double kMinCells = 12.5;
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const std::vector<PaintedCell> cells = MakeGround(seed);
    const std::vector<bool> expected = FindSmallByFlooding(cells, kMinCells);
    const auto num_small = std::count(expected.begin(), expected.end(), true);
    ASSERT_TRUE(num_small > 50 && num_small < std::ssize(cells) / 2);
    for (const int num_rows : {1, 3, 1000}) {
      FreeIslands islands(kMaxStep);
      std::vector<int> all;
      for (size_t begin = 0, end = 0; begin < cells.size(); begin = end) {
        while (end < cells.size() && cells[end].cell.y < cells[begin].cell.y + num_rows) ++end;
        const std::vector<int> some = islands.AddRows(std::span(cells).subspan(begin, end - begin));
        all.insert(all.end(), some.begin(), some.end());
      }
      ASSERT_EQ(all.size(), cells.size());
      for (size_t i = 0; i < cells.size(); ++i)
        EXPECT_EQ(all[i] != FreeIslands::kNone && islands.IsSmall(all[i], kMinCells), expected[i])
            << i;
    }
  }
}

}  // namespace
}  // namespace parkade
