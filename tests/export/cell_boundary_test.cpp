#include "export/cell_boundary.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace parkade {
namespace {

/// Rows from north to south, '#' is a cell; the last row has y = 0.
std::vector<SurfaceCell> Draw(const std::vector<std::string>& rows) {
  std::vector<SurfaceCell> cells;
  for (size_t row = 0; row < rows.size(); ++row)
    for (size_t x = 0; x < rows[row].size(); ++x)
      if (rows[row][x] == '#') {
        SurfaceCell cell;
        cell.x = static_cast<int>(x) - 2;  // negative indices too
        cell.y = static_cast<int>(rows.size() - 1 - row) - 1;
        cell.height = 1.5F;
        cells.push_back(cell);
      }
  return cells;
}

double TotalArea(const std::vector<Ring>& rings) {
  double area = 0;
  for (const Ring& ring : rings) area += SignedArea(ring);
  return area;
}

TEST(TraceBoundary, OneCellIsASquareCounterClockwise) {
  const std::vector<Ring> rings = TraceBoundary(Draw({"#"}), 0.5);

  ASSERT_EQ(rings.size(), 1U);
  EXPECT_EQ(rings[0].size(), 4U);
  EXPECT_NEAR(SignedArea(rings[0]), 0.25, 1e-12);
  for (const Eigen::Vector3d& corner : rings[0]) EXPECT_EQ(corner.z(), 1.5);
  EXPECT_EQ(std::min_element(rings[0].begin(), rings[0].end(),
                             [](const auto& a, const auto& b) { return a.x() < b.x(); })
                ->x(),
            -1);
}

TEST(TraceBoundary, AHoleIsASecondRingTheOtherWayRound) {
  const std::vector<Ring> rings = TraceBoundary(Draw({"#####", "#...#", "#.#.#", "#####"}), 1);

  ASSERT_EQ(rings.size(), 2U);
  EXPECT_NEAR(SignedArea(rings[0]), 20, 1e-12);
  EXPECT_NEAR(SignedArea(rings[1]), -5, 1e-12);
}

TEST(TraceBoundary, AHoleThatTouchesTheOutsideInACornerIsStillAHole) {
  const std::vector<SurfaceCell> cells = Draw({"###.", "#.##", "####"});
  // The hole at (1, 1) and the outside at (3, 2) touch in no corner; this one does:
  const std::vector<SurfaceCell> pinched = Draw({"##..", "#.#.", "###."});

  EXPECT_EQ(TraceBoundary(cells, 1).size(), 2U);
  const std::vector<Ring> rings = TraceBoundary(pinched, 1);
  ASSERT_EQ(rings.size(), 2U);
  EXPECT_GT(SignedArea(rings[0]), 0);
  EXPECT_NEAR(SignedArea(rings[1]), -1, 1e-12);
  EXPECT_NEAR(TotalArea(rings), 7, 1e-12);
}

TEST(TraceBoundary, RandomShapesKeepTheirAreaHaveOneOuterRingAndDoNotDependOnTheOrder) {
  std::mt19937 random(11);
  for (int trial = 0; trial < 50; ++trial) {
    // Grown cell by cell, so connected through edges.
    std::vector<SurfaceCell> cells = Draw({"#"});
    while (cells.size() < 150) {
      SurfaceCell cell = cells[random() % cells.size()];
      const int side = static_cast<int>(random() % 4);
      cell.x += (side == 0) - (side == 1);
      cell.y += (side == 2) - (side == 3);
      const bool is_new = std::none_of(cells.begin(), cells.end(), [&](const SurfaceCell& c) {
        return c.x == cell.x && c.y == cell.y;
      });
      if (is_new) cells.push_back(cell);
    }

    const std::vector<Ring> rings = TraceBoundary(cells, 1);
    std::shuffle(cells.begin(), cells.end(), random);

    EXPECT_NEAR(TotalArea(rings), 150, 1e-9);
    EXPECT_GT(SignedArea(rings[0]), 0);
    for (size_t i = 1; i < rings.size(); ++i) EXPECT_LT(SignedArea(rings[i]), 0);
    EXPECT_EQ(TraceBoundary(cells, 1), rings);
    for (Ring ring : rings) {
      // A ring visits no corner twice: it would not be valid as OGC polygon.
      std::sort(ring.begin(), ring.end(), [](const auto& a, const auto& b) {
        return std::pair(a.x(), a.y()) < std::pair(b.x(), b.y());
      });
      EXPECT_EQ(std::adjacent_find(ring.begin(), ring.end()), ring.end());
    }
  }
}

}  // namespace
}  // namespace parkade
