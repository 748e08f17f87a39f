#include "mapping/surface/deck_rasters.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "mapping/ground/sort_cells.h"

namespace parkade {
namespace {

using PaintedCell = SurfacePainter::PaintedCell;

constexpr double kMaxStep = 0.1;  // [m]

PaintedCell CellAt(int x, int y, double height) {
  PaintedCell cell;
  cell.cell = {.x = x, .y = y, .height = static_cast<float>(height)};
  cell.is_seen = true;
  return cell;
}

/// Which cells are in which raster; each lies where its raster says.
std::vector<std::set<int>> MembersOf(const std::vector<PaintedCell>& cells,
                                     const std::vector<DeckRaster>& decks) {
  std::vector<std::set<int>> members;
  for (const DeckRaster& deck : decks) {
    std::set<int>& of_deck = members.emplace_back();
    for (int row = 0; row < deck.index.rows; ++row)
      for (int column = 0; column < deck.index.cols; ++column) {
        const int i = deck.index.at<int>(row, column);
        if (i < 0) continue;
        EXPECT_EQ(cells[static_cast<size_t>(i)].cell.x, deck.origin.x() + column);
        EXPECT_EQ(cells[static_cast<size_t>(i)].cell.y, deck.origin.y() + row);
        EXPECT_TRUE(of_deck.insert(i).second);
      }
  }
  return members;
}

TEST(DeckRasters, DecksAboveEachOtherAreApart) {
  std::vector<PaintedCell> cells;
  for (int y = -13; y < 20; ++y)
    for (int x = -7; x < 30; ++x) {
      cells.push_back(CellAt(x, y, 0));
      if (x < 10) cells.push_back(CellAt(x, y, 3));
    }
  SortCells(cells);
  const std::vector<DeckRaster> decks =
      CutIntoDecks(cells, LinkPaintedCells(cells, kMaxStep), 4, 10);
  ASSERT_EQ(decks.size(), 2);
  EXPECT_EQ(decks[0].origin, Eigen::Vector2i(-8, -16));
  EXPECT_EQ(decks[0].index.size(), cv::Size(40, 36));
  const std::vector<std::set<int>> members = MembersOf(cells, decks);
  EXPECT_EQ(members[0].size(), 33 * 37);
  EXPECT_EQ(members[1].size(), 33 * 17);
  for (const int i : members[1]) EXPECT_EQ(cells[static_cast<size_t>(i)].cell.height, 3);
}

TEST(DeckRasters, ARampThatWindsAboveItselfIsCutAndWhole) {
  std::vector<PaintedCell> cells;
  for (double turn = 0; turn < 2; turn += 0.001)
    for (int radius = 30; radius < 40; ++radius) {
      const double angle = 2 * M_PI * turn;
      cells.push_back(CellAt(static_cast<int>(std::floor(radius * std::cos(angle))),
                             static_cast<int>(std::floor(radius * std::sin(angle))), 3 * turn));
    }
  SortCells(cells);
  const auto is_same = [](const PaintedCell& a, const PaintedCell& b) {
    return a.cell.x == b.cell.x && a.cell.y == b.cell.y && b.cell.height - a.cell.height < 1;
  };
  cells.erase(std::unique(cells.begin(), cells.end(), is_same), cells.end());
  const std::vector<DeckRaster> decks =
      CutIntoDecks(cells, LinkPaintedCells(cells, kMaxStep), 2, 1);
  size_t sum = 0;
  for (const std::set<int>& members : MembersOf(cells, decks)) sum += members.size();
  EXPECT_EQ(sum, cells.size());
  EXPECT_GE(decks.size(), 2);
  EXPECT_LE(decks.size(), 8);
}

TEST(DeckRasters, WhatIsSmallIsNoDeck) {
  std::vector<PaintedCell> cells;
  for (int y = 0; y < 10; ++y)
    for (int x = 0; x < 20; ++x)
      if (x != 12) cells.push_back(CellAt(x, y, 0));
  const std::vector<DeckRaster> decks =
      CutIntoDecks(cells, LinkPaintedCells(cells, kMaxStep), 2, 100);
  ASSERT_EQ(decks.size(), 1);
  EXPECT_EQ(MembersOf(cells, decks)[0].size(), 120);
  EXPECT_TRUE(CutIntoDecks({}, {}, 2, 1).empty());
}

}  // namespace
}  // namespace parkade
