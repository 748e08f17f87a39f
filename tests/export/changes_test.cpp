#include "export/changes.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace parkade {
namespace {

/// Ground of 20 x 20 cells of 0.5 m with a square of 4 x 4 m that was blocked.
SurfaceChanges BlockedSquare() {
  SurfaceChanges changes{.cell_size = 0.5};
  ChangedRegion region{.change = GroundChange::kBlocked, .area = 16};
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 20; ++x) {
      const bool is_inside = x >= 4 && x < 12 && y >= 6 && y < 14;
      (is_inside ? region.cells : changes.unchanged).push_back({.x = x, .y = y, .height = 1});
    }
  changes.regions.push_back(region);
  return changes;
}

TEST(Changes, AreGeoJsonWithTheirKindAndArea) {
  const auto json = nlohmann::json::parse(EncodeChangesGeoJson(BlockedSquare(), {}));
  EXPECT_EQ(json.at("frame"), "site");
  ASSERT_EQ(json.at("features").size(), 1U);
  const auto& feature = json.at("features")[0];
  EXPECT_EQ(feature.at("properties").at("change"), "blocked");
  EXPECT_EQ(feature.at("properties").at("area_m2"), 16);
  EXPECT_EQ(feature.at("geometry").at("type"), "MultiPolygon");
  const auto& ring = feature.at("geometry").at("coordinates")[0][0];
  ASSERT_EQ(ring.size(), 5U);
  EXPECT_EQ(ring[0], nlohmann::json({2.0, 3.0, 1.0}));
  EXPECT_EQ(ring[0], ring[4]);
}

TEST(Changes, LieOnEarthWhereTheMapDoes) {
  const auto json = nlohmann::json::parse(EncodeChangesGeoJson(
      BlockedSquare(), SiteDatum{.latitude_deg = 48, .longitude_deg = 11, .altitude = 500}));
  EXPECT_FALSE(json.contains("frame"));
  const auto& corner = json.at("features")[0].at("geometry").at("coordinates")[0][0][0];
  EXPECT_NEAR(corner[0].get<double>(), 11 + 2 / (111320 * std::cos(48 * M_PI / 180)), 1e-6);
  EXPECT_NEAR(corner[2].get<double>(), 501, 1e-3);
}

TEST(Changes, OfGroundAboveItselfAreSeveralPolygons) {
  SurfaceChanges changes{.cell_size = 0.5};
  ChangedRegion region{.change = GroundChange::kMapped};
  // A ramp that turns back below itself.
  for (int x = 0; x < 20; ++x)
    region.cells.push_back({.x = x, .y = 0, .height = 0.2F * static_cast<float>(x)});
  region.cells.push_back({.x = 19, .y = 1, .height = 4});
  for (int x = 19; x >= 0; --x)
    region.cells.push_back({.x = x, .y = 2, .height = 4 + 0.2F * static_cast<float>(19 - x)});
  for (int x = 0; x < 20; ++x) region.cells.push_back({.x = x, .y = 0, .height = 7});
  std::sort(region.cells.begin(), region.cells.end(),
            [](const SurfaceCell& a, const SurfaceCell& b) {
              return std::tuple(a.y, a.x, a.height) < std::tuple(b.y, b.x, b.height);
            });
  changes.regions.push_back(region);
  const auto json = nlohmann::json::parse(EncodeChangesGeoJson(changes, {}));
  EXPECT_GE(json.at("features")[0].at("geometry").at("coordinates").size(), 2U);
}

TEST(Changes, ArePaintedInTheirColors) {
  const Orthophoto image = RenderChanges(BlockedSquare());
  ASSERT_EQ(image.image.size(), cv::Size(20, 20));
  const cv::Vec4b inside = image.image.at<cv::Vec4b>(20 - 1 - 8, 6),
                  outside = image.image.at<cv::Vec4b>(0, 0);
  EXPECT_GT(inside[2], 3 * inside[1]) << "red";
  EXPECT_NEAR(outside[2], outside[1], 10) << "gray";
}

}  // namespace
}  // namespace parkade
