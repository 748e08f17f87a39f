#include "export/markings.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace parkade {
namespace {

using nlohmann::json;

/// A slot of an upper deck, free on one day and taken on the next.
ParkingSlot UpperSlot() {
  ParkingSlot slot;
  slot.id = "slot_a";
  slot.corners = {Eigen::Vector3d(10, 20, 3), {12.5, 20, 3}, {12.5, 25, 3}, {10, 25, 3}};
  slot.kind = SlotKind::kAngled;
  slot.angle = M_PI / 3;
  slot.confidence = 0.876;
  slot.num_marked_sides = 2;
  slot.states = {SlotState::kFree, SlotState::kOccupied, SlotState::kUnseen};
  return slot;
}

std::vector<FreeSheet> TwoDecks() {
  FreeSheet lower, upper;
  lower.max_height = 0.2, lower.mean_height = 0.1;
  upper.level = 1, upper.min_height = 2.8, upper.max_height = 3.2, upper.mean_height = 3;
  return {lower, upper};
}

TEST(Markings, OfSlotsAreClosedPolygonsWithAllThatIsKnown) {
  const auto text =
      EncodeSlotsGeoJson({UpperSlot()}, {"monday", "tuesday", "friday"}, TwoDecks(), {});
  const json collection = json::parse(text);
  EXPECT_EQ(collection.at("frame"), "site");
  const json& feature = collection.at("features").at(0);
  const json& ring = feature.at("geometry").at("coordinates").at(0);
  ASSERT_EQ(ring.size(), 5U);
  EXPECT_EQ(ring[0], ring[4]);
  EXPECT_EQ(ring[1], json({12.5, 20.0, 3.0}));
  const json& properties = feature.at("properties");
  EXPECT_EQ(properties.at("id"), "slot_a");
  EXPECT_EQ(properties.at("type"), "angled");
  EXPECT_DOUBLE_EQ(properties.at("width_m"), 2.5);
  EXPECT_DOUBLE_EQ(properties.at("length_m"), 5);
  EXPECT_DOUBLE_EQ(properties.at("angle_deg"), 60);
  EXPECT_EQ(properties.at("level"), 1);
  EXPECT_DOUBLE_EQ(properties.at("confidence"), 0.88);
  EXPECT_EQ(properties.at("state"), "occupied");
  EXPECT_EQ(properties.at("states"),
            json({{"monday", "free"}, {"tuesday", "occupied"}, {"friday", "unseen"}}));
  EXPECT_EQ(text,
            EncodeSlotsGeoJson({UpperSlot()}, {"monday", "tuesday", "friday"}, TwoDecks(), {}));
}

TEST(Markings, LieOnEarthWhereTheSiteDoes) {
  const SiteDatum datum{48, 11, 500};
  const json collection = json::parse(EncodeSlotsGeoJson({UpperSlot()}, {}, TwoDecks(), datum));
  EXPECT_FALSE(collection.contains("frame"));
  const json& corner = collection.at("features").at(0).at("geometry").at("coordinates").at(0).at(0);
  EXPECT_LT((SiteFromGeodetic(datum, corner[1], corner[0], corner[2]) - Eigen::Vector3d(10, 20, 3))
                .norm(),
            0.002);
}

TEST(Markings, AreLinesAreasAndBumps) {
  GroundMarkings markings;
  markings.markings.push_back(
      {RoadMarking::Shape::kLine, true, true, 0.12, {{0, 0, 0}, {5, 0, 0}}});
  markings.markings.push_back(
      {RoadMarking::Shape::kArea, false, false, 0, {{0, 0, 0}, {0, 1, 0}, {1, 0, 0}}});
  markings.bumps.push_back({{7, 8, 0.1}, M_PI / 2, 0.0614, 3.2, 2});
  const json features = json::parse(EncodeMarkingsGeoJson(markings, TwoDecks(), {})).at("features");
  ASSERT_EQ(features.size(), 3U);
  EXPECT_EQ(features[0].at("geometry").at("type"), "LineString");
  EXPECT_EQ(features[0].at("properties").at("color"), "yellow");
  EXPECT_EQ(features[0].at("properties").at("bounds_slot"), true);
  const json& ring = features[1].at("geometry").at("coordinates").at(0);
  EXPECT_EQ(ring, json({{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}}))
      << "counter-clockwise";
  EXPECT_EQ(features[2].at("geometry").at("type"), "Point");
  EXPECT_DOUBLE_EQ(features[2].at("properties").at("height_m"), 0.061);
  EXPECT_DOUBLE_EQ(features[2].at("properties").at("yaw_deg"), 90);
}

TEST(Markings, KerbsHaveTheirHeightAndLengthOnTheirLevel) {
  GroundMarkings markings;
  markings.kerbs.push_back({{{0, 0, 3}, {4, 0, 3}, {4, 3, 3.1}}, 0.1184, 0.0061, 3.456});
  const json features = json::parse(EncodeMarkingsGeoJson(markings, TwoDecks(), {})).at("features");
  ASSERT_EQ(features.size(), 1U);
  EXPECT_EQ(features[0].at("geometry").at("type"), "LineString");
  EXPECT_EQ(features[0].at("geometry").at("coordinates"),
            json({{0.0, 0.0, 3.0}, {4.0, 0.0, 3.0}, {4.0, 3.0, 3.1}}));
  const json& properties = features[0].at("properties");
  EXPECT_EQ(properties.at("type"), "kerb");
  EXPECT_DOUBLE_EQ(properties.at("height_m"), 0.118);
  EXPECT_DOUBLE_EQ(properties.at("height_sigma_m"), 0.006);
  EXPECT_DOUBLE_EQ(properties.at("length_m"), 7);
  EXPECT_DOUBLE_EQ(properties.at("hidden_m"), 3.46);
  EXPECT_EQ(properties.at("level"), 1);
  EXPECT_EQ(properties.at("points_m"), features[0].at("geometry").at("coordinates"));
}

TEST(Markings, OfNothingAreEmptyCollections) {
  EXPECT_TRUE(json::parse(EncodeSlotsGeoJson({}, {}, {}, {})).at("features").empty());
  EXPECT_TRUE(json::parse(EncodeMarkingsGeoJson({}, {}, {})).at("features").empty());
}

}  // namespace
}  // namespace parkade
