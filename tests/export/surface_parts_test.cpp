#include "export/surface_parts.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace parkade {
namespace {

/// Cells of 0.1 m over x, y in [0, size) by what `of(x, y)` shows.
template <typename Of>
SurfaceMap Ground(int size, const Of& of) {
  SurfaceMap surface;
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const SurfaceClass shown = of(x, y);
      SurfaceCell cell{.x = x, .y = y};
      cell.height = IsForCars(shown) ? 0.0F : 0.1F;
      cell.free_belief = IsForCars(shown) ? 0.9F : 0.1F;
      if (shown != SurfaceClass::kUnknown)
        cell.class_beliefs[static_cast<std::size_t>(shown)] = 200;
      surface.cells.push_back(cell);
    }
  return surface;
}

TEST(SurfaceParts, AreOfOneClassAndOfNoneForCars) {
  const auto of = [](int x, int y) {
    if (x < 20) return SurfaceClass::kDrivable;
    if (x < 24) return SurfaceClass::kKerb;
    return y < 30 ? SurfaceClass::kPavement : SurfaceClass::kVegetation;
  };
  const std::vector<SurfacePart> parts = FindSurfaceParts(Ground(40, of));

  ASSERT_EQ(parts.size(), 3U);
  const std::vector<std::pair<SurfaceClass, double>> expected = {
      {SurfaceClass::kKerb, 0.4 * 4},
      {SurfaceClass::kPavement, 1.6 * 3},
      {SurfaceClass::kVegetation, 1.6 * 1}};
  for (std::size_t i = 0; i < parts.size(); ++i) {
    EXPECT_EQ(parts[i].surface, expected[i].first) << i;
    EXPECT_NEAR(parts[i].area, expected[i].second, 1e-9) << i;
    ASSERT_EQ(parts[i].rings.size(), 1U) << i;
    EXPECT_NEAR(SignedArea(parts[i].rings[0]), parts[i].area, 1e-9) << i;
    EXPECT_NEAR(parts[i].mean_height, 0.1, 1e-6) << i;
  }
}

TEST(SurfaceParts, SmallOnesAndWhatIsUnknownAreLeftOut) {
  const auto of = [](int x, int y) {
    if (x < 6 && y < 6) return SurfaceClass::kVehicle;
    return x > 20 ? SurfaceClass::kUnknown : SurfaceClass::kDrivable;
  };
  EXPECT_TRUE(FindSurfaceParts(Ground(40, of)).empty());
}

TEST(SurfaceParts, WhatTheMapCallsFreeIsNoPavementWhateverImagesShow) {
  SurfaceMap surface = Ground(20, [](int, int) { return SurfaceClass::kPavement; });
  for (SurfaceCell& cell : surface.cells) cell.free_belief = 0.9F;
  EXPECT_TRUE(FindSurfaceParts(surface).empty());
}

TEST(SurfaceParts, NoneLiesAboveItself) {
  SurfaceMap surface;  // a pavement that goes up, and back above itself
  for (int y = 0; y < 10; ++y)
    for (int x = 0; x < 60; ++x)
      for (const bool is_back : {false, true}) {
        SurfaceCell cell{.x = x, .y = y};
        cell.height = 0.1F * static_cast<float>(is_back ? 120 - x : x) / 2;
        cell.class_beliefs[static_cast<std::size_t>(SurfaceClass::kPavement)] = 255;
        surface.cells.push_back(cell);
      }
  double area = 0;
  for (const SurfacePart& part : FindSurfaceParts(surface)) {
    double of_rings = 0;
    for (const Ring& ring : part.rings) of_rings += SignedArea(ring);
    EXPECT_NEAR(of_rings, part.area, 1e-9);
    area += part.area;
  }
  EXPECT_NEAR(area, 2 * 6.0 * 1.0, 1.0);
}

TEST(SurfaceParts, GeoJsonTellsClassLevelAndPlace) {
  const SurfaceMap surface = Ground(20, [](int, int) { return SurfaceClass::kPavement; });
  const auto json = nlohmann::json::parse(EncodeSurfacesGeoJson(FindSurfaceParts(surface), {}, {}));

  ASSERT_EQ(json["features"].size(), 1U);
  const auto& feature = json["features"][0];
  EXPECT_EQ(feature["properties"]["surface"], "pavement");
  EXPECT_EQ(feature["properties"]["level"], 0);
  EXPECT_NEAR(feature["properties"]["area_m2"].get<double>(), 4, 1e-9);
  EXPECT_EQ(feature["geometry"]["coordinates"][0].size(), 5U);
}

}  // namespace
}  // namespace parkade
