#include "export/lanelet2/cell_region.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace parkade {
namespace {

using Eigen::Vector2d;
using CellSet = std::set<std::pair<int, int>>;  // (y, x)

CellRegion RegionOf(const CellSet& cells) {
  CellRegion region;
  for (const auto& [y, x] : cells) {
    if (!region.empty() && region.back().y == y && region.back().end == x)
      ++region.back().end;
    else
      region.push_back({y, x, x + 1});
  }
  return region;
}

CellSet CellsOf(const CellRegion& region) {
  CellSet cells;
  for (const CellSpan& span : region)
    for (int x = span.begin; x < span.end; ++x) cells.emplace(span.y, x);
  return cells;
}

CellSet RandomCells(std::mt19937& random) {
  CellSet cells;
  for (int y = -6; y < 6; ++y)
    for (int x = -6; x < 6; ++x)
      if (random() % 100 < 60) cells.emplace(y, x);
  return cells;
}

TEST(CellRegions, AreCombinedAsSetsOfCells) {
  std::mt19937 random(1);
  for (int trial = 0; trial < 50; ++trial) {
    const CellSet a = RandomCells(random), b = RandomCells(random);
    CellSet both = a, common, rest;
    both.insert(b.begin(), b.end());
    std::ranges::set_intersection(a, b, std::inserter(common, common.end()));
    std::ranges::set_difference(a, b, std::inserter(rest, rest.end()));

    EXPECT_EQ(Unite(RegionOf(a), RegionOf(b)), RegionOf(both));
    EXPECT_EQ(Intersect(RegionOf(a), RegionOf(b)), RegionOf(common));
    EXPECT_EQ(Subtract(RegionOf(a), RegionOf(b)), RegionOf(rest));
    EXPECT_EQ(CountCells(RegionOf(a)), static_cast<long>(a.size()));
  }
}

TEST(CellRegions, AreTracedAndFilledPieceByPiece) {
  std::mt19937 random(2);
  for (int trial = 0; trial < 50; ++trial) {
    const CellSet cells = RandomCells(random);
    CellRegion all;
    for (const CellRegion& piece : SplitIntoPieces(RegionOf(cells))) {
      const std::vector<Ring> rings = TraceBoundary(piece, 0.05);
      EXPECT_EQ(FillRings(rings, 0.05), piece);
      EXPECT_GT(SignedArea(rings.front()), 0);
      EXPECT_TRUE(Intersect(all, piece).empty());
      all = Unite(all, piece);
    }
    EXPECT_EQ(CellsOf(all), cells);
  }
}

TEST(CellRegions, PiecesAreConnectedThroughEdges) {
  EXPECT_EQ(SplitIntoPieces({{0, 0, 2}, {1, 2, 4}}).size(), 2U);
  EXPECT_EQ(SplitIntoPieces({{0, 0, 3}, {1, 2, 4}}).size(), 1U);
  EXPECT_EQ(SplitIntoPieces({{0, 0, 1}, {0, 4, 5}, {1, 0, 5}}).size(), 1U);
  EXPECT_EQ(SplitIntoPieces({{0, 0, 3}, {2, 0, 3}}).size(), 2U);
}

TEST(CellRegions, OfAPolygonHaveEachCellThatItTouches) {
  EXPECT_EQ(FillTouched(std::vector<Vector2d>{{0, 0}, {1, 0}, {1, 1}, {0, 1}}, 0.5),
            CellRegion({{-1, -1, 3}, {0, -1, 3}, {1, -1, 3}, {2, -1, 3}}));
}

TEST(CellRegions, OfAPolygonHaveNoOtherCell) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int trial = 0; trial < 30; ++trial) {
    const Vector2d center(uniform(random), uniform(random)),
        along(uniform(random), uniform(random));
    const Vector2d across(-0.4 * along.y(), 0.4 * along.x());
    const CellSet touched =
        CellsOf(FillTouched(std::vector<Vector2d>{center - along - across, center + along - across,
                                                  center + along + across, center - along + across},
                            0.1));
    // Two convex shapes are apart where a side of one has the other on its far side.
    for (int y = -40; y < 40; ++y)
      for (int x = -40; x < 40; ++x) {
        const Vector2d offset = 0.1 * Vector2d(x + 0.5, y + 0.5) - center;
        bool is_apart = std::abs(offset.x()) > 0.05 + std::abs(along.x()) + std::abs(across.x()) ||
                        std::abs(offset.y()) > 0.05 + std::abs(along.y()) + std::abs(across.y());
        for (const Vector2d& axis : {along, across})
          is_apart |= std::abs(offset.dot(axis)) >
                      axis.squaredNorm() + 0.05 * (std::abs(axis.x()) + std::abs(axis.y()));
        EXPECT_EQ(touched.contains({y, x}), !is_apart) << x << " " << y;
      }
  }
}

}  // namespace
}  // namespace parkade
