#include "export/lanelet2/lanelet2_map.h"

#include <gtest/gtest.h>

#include <set>

#include "core/error.h"
#include "export/lanelet2/osm_file.h"
#include "tests/export/lanelet2/parking_example.h"

namespace parkade {
namespace {

size_t Count(const std::string& text, const std::string& part) {
  size_t count = 0;
  for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

std::string Tag(const std::string& key, const std::string& value) {
  return "<tag k=\"" + key + "\" v=\"" + value + "\" />";
}

// What is in the file is read by read_lanelet2.py.

TEST(Lanelet2Map, IsTheSameForTheSameMap) {
  const SiteMap map = MakeParkingExample(true);
  EXPECT_EQ(EncodeLanelet2(ParkingMapOf(map), map.datum),
            EncodeLanelet2(ParkingMapOf(MakeParkingExample(true)), map.datum));
}

TEST(Lanelet2Map, CanBeOfOneLevel) {
  const ParkingMap map = ParkingMapOf(MakeParkingExample(false));
  const std::string all = EncodeLanelet2(map, {}), upper = EncodeLanelet2(map, {}, 1);

  EXPECT_EQ(Count(all, Tag("type", "parking_space")), map.slots.size());
  EXPECT_EQ(Count(upper, Tag("type", "parking_space")), 1U);
  EXPECT_EQ(Count(upper, Tag("type", "parking_lot")), 1U);
  EXPECT_EQ(Count(upper, Tag("type", "curbstone")), 1U);
  EXPECT_EQ(Count(upper, Tag("level", "0")), 0U);
  EXPECT_EQ(Count(upper, Tag("level", "1")), Count(all, Tag("level", "1")));
}

TEST(Lanelet2Map, SaysWhatItCannotBeMadeOf) {
  EXPECT_THROW(EncodeLanelet2({}, {}), Error);
  const ParkingMap map = ParkingMapOf(MakeParkingExample(false));
  try {
    EncodeLanelet2(map, {}, 2);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kUsage);
    EXPECT_STREQ(error.what(), "the map has no level 2, but: 0, 1");
  }
}

TEST(Lanelet2Map, NeedsNoSlotsAndNoFreeGround) {
  ParkingMap map = ParkingMapOf(MakeParkingExample(false));
  map.slots.clear();
  EXPECT_EQ(Count(EncodeLanelet2(map, {}), Tag("type", "parking_lot")), 2U);

  const ParkingSlot slot = MakeParkingExample(false).markings.slots.front();
  const std::string text = EncodeLanelet2({.slots = {{"a<b>&\"c\"", slot}}}, {});
  EXPECT_EQ(Count(text, Tag("type", "parking_lot")), 1U);
  EXPECT_EQ(Count(text, "\"a&lt;b"), 1U);
  EXPECT_EQ(Count(text, "&amp;&quot;c&quot;\""), 1U);
}

TEST(OsmFiles, HaveNoEmptyLinesAndShareNodes) {
  OsmFile file({});
  EXPECT_FALSE(file.AddLine(std::vector<Eigen::Vector3d>{{1, 2, 3}, {1, 2.0004, 3}}, {}));
  EXPECT_TRUE(file.AddLine(std::vector<Eigen::Vector3d>{{1, 2, 3}, {1, 2, 3}, {4, 2, 3}}, {}));
  EXPECT_TRUE(file.AddLine(std::vector<Eigen::Vector3d>{{4, 2, 3}, {-0.0001, 5, 3}}, {}));
  const std::string text = file.Encode();
  EXPECT_EQ(Count(text, "<node "), 3U);
  EXPECT_EQ(Count(text, "<nd "), 4U);
  EXPECT_EQ(Count(text, "\"-0.000\""), 0U);
}

}  // namespace
}  // namespace parkade
