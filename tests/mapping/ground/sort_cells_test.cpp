#include "mapping/ground/sort_cells.h"

#include <gtest/gtest.h>

#include <random>

#include "mapping/surface/surface_painter.h"

namespace parkade {
namespace {

using PaintedCell = SurfacePainter::PaintedCell;

TEST(SortCells, ByRowThenColumnThenHeight) {
  std::mt19937 random(4);
  std::uniform_int_distribution<int> row(-30, 40), column(-5, 5);
  std::uniform_real_distribution<float> height(-3, 3);
  std::vector<PaintedCell> cells(5000);
  for (PaintedCell& painted : cells) {
    painted.cell.y = row(random), painted.cell.x = column(random);
    painted.cell.height = height(random);
    painted.is_seen = painted.cell.height > 0;
  }
  std::vector<PaintedCell> expected = cells;
  std::sort(expected.begin(), expected.end(), [](const PaintedCell& a, const PaintedCell& b) {
    return std::tie(a.cell.y, a.cell.x, a.cell.height) <
           std::tie(b.cell.y, b.cell.x, b.cell.height);
  });

  SortCells(cells);

  ASSERT_EQ(cells.size(), expected.size());
  for (size_t i = 0; i < cells.size(); ++i) {
    EXPECT_EQ(cells[i].cell.y, expected[i].cell.y);
    EXPECT_EQ(cells[i].cell.x, expected[i].cell.x);
    EXPECT_EQ(cells[i].cell.height, expected[i].cell.height);
    EXPECT_EQ(cells[i].is_seen, expected[i].is_seen);
  }
}

TEST(SortCells, NothingAndOneAreSorted) {
  std::vector<PaintedCell> cells;
  SortCells(cells);
  EXPECT_TRUE(cells.empty());
  cells.emplace_back().cell.y = -7;
  SortCells(cells);
  ASSERT_EQ(cells.size(), 1U);
  EXPECT_EQ(cells[0].cell.y, -7);
}

}  // namespace
}  // namespace parkade
