#include "export/free_space.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <tuple>

#include "core/error.h"
#include "tests/export/example_map.h"

namespace parkade {
namespace {

/// Cells of 0.5 m over x, y in [0, size), at a height by (x, y).
template <typename Height>
SurfaceMap Plane(int size, const Height& height) {
  SurfaceMap surface;
  surface.cell_size = 0.5;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      SurfaceCell cell;
      cell.x = x;
      cell.y = y;
      cell.height = static_cast<float>(height(x, y));
      cell.free_belief = 0.9F;
      surface.cells.push_back(cell);
    }
  }
  return surface;
}

TEST(FreeSpace, ASteepEnoughKerbSeparatesAndARampDoesNot) {
  EXPECT_EQ(FindFreeSheets(Plane(20, [](int x, int) { return x < 10 ? 0.0 : 0.2; })).size(), 2U);
  EXPECT_EQ(FindFreeSheets(Plane(20, [](int x, int) { return 0.06 * x; })).size(), 1U);  // 12 %
}

TEST(FreeSpace, WhatIsNotFreeOrUnknownIsAHole) {
  SurfaceMap surface = Plane(20, [](int, int) { return 0.0; });
  for (SurfaceCell& cell : surface.cells)
    if (cell.x == 5 && cell.y == 5) cell.free_belief = 0.4F;
  std::erase_if(surface.cells,
                [](const SurfaceCell& cell) { return cell.x == 10 && cell.y == 10; });

  const std::vector<FreeSheet> sheets = FindFreeSheets(surface);

  ASSERT_EQ(sheets.size(), 1U);
  EXPECT_EQ(sheets[0].rings.size(), 3U);
  EXPECT_NEAR(sheets[0].area, 398 * 0.25, 1e-9);
}

TEST(FreeSpace, AGarageIsCutInItsRampIntoLevels) {
  const SiteMap garage = MakeExampleMap(false);
  const std::vector<FreeSheet> sheets = FindFreeSheets(garage.surface);

  ASSERT_EQ(sheets.size(), 2U);
  EXPECT_EQ(sheets[0].level, 0);
  EXPECT_EQ(sheets[1].level, 1);
  EXPECT_NEAR(sheets[1].max_height, kUpperDeckHeight - 0.1, 1e-6);
  EXPECT_NEAR(sheets[0].max_height, 1.2, 0.1);
  EXPECT_EQ(sheets[0].rings.size(), 2U);  // the pillar
  EXPECT_NEAR(SignedArea(sheets[0].rings[1]), -1, 1e-9);
  // Nothing is lost: all cells that are free.
  const auto num_free =
      std::count_if(garage.surface.cells.begin(), garage.surface.cells.end(),
                    [](const SurfaceCell& cell) { return cell.free_belief > 0.5F; });
  EXPECT_NEAR(sheets[0].area + sheets[1].area, static_cast<double>(num_free) * 0.0625, 1e-6);
}

TEST(FreeSpace, AHelixOfThreeTurnsIsCutOncePerTurn) {
  SurfaceMap surface;
  surface.cell_size = 0.25;
  for (int turn = 0; turn < 3; ++turn) {
    for (int y = -40; y < 40; ++y) {
      for (int x = -40; x < 40; ++x) {
        const double radius = std::hypot(x + 0.5, y + 0.5),
                     angle = std::atan2(y + 0.5, x + 0.5) + M_PI;
        if (radius < 25 || radius > 39) continue;
        SurfaceCell cell;
        cell.x = x;
        cell.y = y;
        cell.height = static_cast<float>(3 * (turn + angle / (2 * M_PI)));
        cell.free_belief = 1;
        surface.cells.push_back(cell);
      }
    }
  }
  std::sort(surface.cells.begin(), surface.cells.end(),
            [](const SurfaceCell& a, const SurfaceCell& b) {
              return std::tuple(a.y, a.x, a.height) < std::tuple(b.y, b.x, b.height);
            });

  const std::vector<FreeSheet> sheets = FindFreeSheets(surface);

  double area = 0;
  for (const FreeSheet& sheet : sheets) {
    EXPECT_GT(SignedArea(sheet.rings[0]), 0);
    EXPECT_LE(sheet.max_height - sheet.min_height, 3.1);
    area += sheet.area;
  }
  EXPECT_GE(sheets.size(), 3U);
  EXPECT_LE(sheets.size(), 4U);
  EXPECT_NEAR(area, static_cast<double>(surface.cells.size()) * 0.0625, 2.0);
}

TEST(FreeSpace, SpecklesAreLeftOut) {
  SurfaceMap surface;
  surface.cell_size = 0.5;
  SurfaceCell cell;
  cell.free_belief = 1;
  surface.cells = {cell};
  EXPECT_TRUE(FindFreeSheets(surface).empty());
  EXPECT_TRUE(FindFreeSheets({}).empty());
  EXPECT_EQ(FindFreeSheets(surface, {.min_area = 0}).size(), 1U);
}

TEST(FreeSpace, GeoJsonIsClosedAndSaysItsFrame) {
  const SurfaceMap surface = Plane(4, [](int, int) { return 1.0; });
  const std::vector<FreeSheet> sheets = FindFreeSheets(surface);

  const auto local = nlohmann::json::parse(EncodeFreeSpaceGeoJson(sheets, {}));
  const auto global = nlohmann::json::parse(EncodeFreeSpaceGeoJson(sheets, SiteDatum{48, 11, 500}));

  EXPECT_EQ(local.at("frame"), "site");
  EXPECT_FALSE(global.contains("frame"));
  const auto& ring = local.at("features").at(0).at("geometry").at("coordinates").at(0);
  ASSERT_EQ(ring.size(), 5U);
  EXPECT_EQ(ring[0], ring[4]);
  EXPECT_EQ(ring[0], nlohmann::json({0.0, 0.0, 1.0}));
  const auto& corner = global.at("features").at(0).at("geometry").at("coordinates").at(0).at(2);
  const Eigen::Vector3d in_site = SiteFromGeodetic({48, 11, 500}, corner[1], corner[0], corner[2]);
  EXPECT_LT((in_site - Eigen::Vector3d(2, 2, 1)).norm(), 2e-3);
}

TEST(FreeSpace, OptionsOutOfRangeAreRefused) {
  EXPECT_THROW(FindFreeSheets({}, {.max_step = 0}), Error);
  EXPECT_THROW(FindFreeSheets({}, {.min_belief = 1.5}), Error);
}

}  // namespace
}  // namespace parkade
