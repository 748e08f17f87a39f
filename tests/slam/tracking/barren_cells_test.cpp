#include "slam/tracking/barren_cells.h"

#include <gtest/gtest.h>

namespace parkade {
namespace {

constexpr std::int64_t kImages = 40;

int CountTries(const BarrenCells& cells, const Eigen::Vector2d& pixel) {
  int tries = 0;
  for (std::int64_t image = 0; image < kImages; ++image) tries += cells.Rests(pixel, image) ? 0 : 1;
  return tries;
}

TEST(BarrenCells, EveryCellIsTriedAtFirst) {
  const BarrenCells cells(640, 400, 64);

  EXPECT_EQ(CountTries(cells, {0, 0}), kImages);
  EXPECT_EQ(CountTries(cells, {639.9, 399.9}), kImages);
}

TEST(BarrenCells, WhereTracksAreLostAtOnceTheirCellRestsAndOthersDoNot) {
  BarrenCells cells(640, 400, 64);

  for (int i = 0; i < 10; ++i) cells.Note({100, 350}, false);

  EXPECT_EQ(CountTries(cells, {120, 330}), kImages / 4) << "the same cell";
  EXPECT_EQ(CountTries(cells, {130, 350}), kImages) << "the next one";
}

TEST(BarrenCells, ACellWakesWhenTracksLive) {
  BarrenCells cells(640, 400, 64);
  for (int i = 0; i < 100; ++i) cells.Note({100, 350}, false);

  for (int i = 0; i < 2; ++i) cells.Note({100, 350}, true);

  EXPECT_EQ(CountTries(cells, {100, 350}), kImages);
}

TEST(BarrenCells, ACellOfWhichHalfLivesIsAlwaysTried) {
  BarrenCells cells(640, 400, 64);
  int rested = 0;

  for (int i = 0; i < 300; ++i) {
    cells.Note({10, 10}, i % 2 == 0);
    rested += CountTries(cells, {10, 10}) < kImages;
  }

  EXPECT_EQ(rested, 0);
}

}  // namespace
}  // namespace parkade
