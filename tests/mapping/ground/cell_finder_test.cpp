#include "mapping/ground/cell_finder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "mapping/ground/surface_window.h"
#include "tests/mapping/worlds/test_surfaces.h"

namespace parkade {
namespace {

/// A plain with random holes, here and there a second deck, and an islet far off.
SurfaceMap MakeHoles() {
  std::mt19937 random(7);
  SurfaceMap surface{0.1, {}};
  for (int y = -40; y < 30; ++y)
    for (int x = -50; x < 70; ++x) {
      if (random() % 3 == 0 || y == 11) continue;
      surface.cells.push_back({.x = x, .y = y, .height = 0.01F * static_cast<float>(x)});
      if (random() % 5 == 0) surface.cells.push_back({.x = x, .y = y, .height = 2.5F});
    }
  surface.cells.push_back({.x = 4000, .y = 90, .height = 1});
  return surface;
}

const SurfaceCell* FindByLookingAtAll(const SurfaceMap& surface, const Eigen::Vector3d& point) {
  for (int ring = 0; ring <= 2; ++ring) {
    const SurfaceCell* nearest = nullptr;
    double nearest_distance = 0;
    for (const SurfaceCell& cell : surface.cells) {
      const int dx = cell.x - static_cast<int>(std::floor(point.x() / surface.cell_size));
      const int dy = cell.y - static_cast<int>(std::floor(point.y() / surface.cell_size));
      if (std::max(std::abs(dx), std::abs(dy)) > ring) continue;
      const double distance = std::abs(static_cast<double>(cell.height) - point.z()) +
                              std::hypot((cell.x + 0.5) * surface.cell_size - point.x(),
                                         (cell.y + 0.5) * surface.cell_size - point.y());
      if (nearest == nullptr || distance < nearest_distance)
        nearest = &cell, nearest_distance = distance;
    }
    if (nearest != nullptr) return nearest;
  }
  return nullptr;
}

TEST(CellFinder, FindsWhatLookingAtAllCellsFinds) {
  const SurfaceMap surface = MakeHoles();
  const CellFinder finder(surface);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> coordinate(-6, 8), height(-1, 4);
  int num_found = 0;
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d point(coordinate(random), coordinate(random), height(random));
    const SurfaceCell* found = finder.Find(point);
    ASSERT_EQ(found, FindByLookingAtAll(surface, point)) << point.transpose();
    num_found += found != nullptr;
  }
  EXPECT_GT(num_found, 500);
  EXPECT_LT(num_found, 1900);
  EXPECT_EQ(finder.Find({400.05, 9.05, 1}), &surface.cells.back());
}

TEST(CellFinder, OfNothingFindsNothing) {
  const SurfaceMap nothing;
  EXPECT_EQ(CellFinder(nothing).Find({0, 0, 0}), nullptr);
}

TEST(SurfaceWindow, HoldsTheCellsInItInOrder) {
  const SurfaceMap surface = MakeHoles();
  const Eigen::AlignedBox2i window(Eigen::Vector2i(-7, 5), Eigen::Vector2i(20, 2000));
  std::vector<const SurfaceCell*> expected, found;
  for (const SurfaceCell& cell : surface.cells)
    if (cell.x >= -7 && cell.x < 20 && cell.y >= 5) expected.push_back(&cell);
  VisitRows(surface, window, [&](std::span<const SurfaceCell> cells) {
    for (const SurfaceCell& cell : cells) found.push_back(&cell);
  });
  EXPECT_EQ(found, expected);
  EXPECT_EQ(CutOut(surface, window).cells.size(), expected.size());
}

}  // namespace
}  // namespace parkade
