#include "server/map_folder/kept_links.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/files/file.h"
#include "slam/sessions/drive_join_json.h"
#include "slam/sessions/join_drives.h"
#include "tests/server/store/temporary_root.h"

namespace parkade {
namespace {

SessionLoop Link(size_t keyframe_a, size_t keyframe_b) {
  SessionLoop link;
  link.keyframe_a = keyframe_a, link.keyframe_b = keyframe_b;
  link.pose.a_from_b = {ExpSo3({0.01, -0.02, 1.5}), {1, 2, 0.5}};
  for (int row = 0; row < 6; ++row)
    for (int column = 0; column < 6; ++column)
      link.pose.information(row, column) = row == column ? 1e4 : 10.0 * (row + column);
  return link;
}

class KeptLinksTest : public testing::Test {
 protected:
  /// The report of a map of three drives, of which the first and the last are linked.
  void WriteReport(const nlohmann::json& join) {
    const nlohmann::json report = {
        {"datum", nullptr},
        {"drives", {{{"name", "one"}}, {{"name", "two"}}, {{"name", "three"}}}},
        {"join", join}};
    WriteFileAtomically(root_.path() / "report.json", report.dump());
  }
  nlohmann::json Join() {
    DriveJoin join;
    DrivePair& pair = join.pairs.emplace_back();
    pair.drive_a = 0, pair.drive_b = 2;
    pair.found.links = {Link(3, 4), Link(5, 6)};
    pair.weights = {1, 0};
    pair.chi_squared = {2, 90};
    return ToJson(join, {"one", "two", "three"});
  }
  TemporaryRoot root_;
};

TEST_F(KeptLinksTest, AreThoseThatWereBelievedToTheLastDigit) {
  WriteReport(Join());
  const std::vector<KeptLink> links = ReadKeptLinks(MapReader(root_.path()), {"three", "one"});
  ASSERT_EQ(links.size(), 1u);
  EXPECT_EQ(links[0].drive_a, 1u);
  EXPECT_EQ(links[0].drive_b, 0u);
  EXPECT_EQ(links[0].keyframe_a, 3u);
  EXPECT_EQ(links[0].keyframe_b, 4u);
  const SessionLoop truth = Link(3, 4);
  EXPECT_EQ(links[0].information, truth.pose.information);
  EXPECT_EQ(links[0].a_from_b.translation, truth.pose.a_from_b.translation);
  EXPECT_LT(links[0].a_from_b.rotation.angularDistance(truth.pose.a_from_b.rotation), 1e-12);
}

TEST_F(KeptLinksTest, OfDrivesThatLeftOrOfOlderMapsThereAreNone) {
  WriteReport(Join());
  EXPECT_TRUE(ReadKeptLinks(MapReader(root_.path()), {"two", "one"}).empty());
  nlohmann::json older = Join();
  for (nlohmann::json& link : older["pairs"][0]["links"]) link.erase("information");
  WriteReport(older);
  EXPECT_TRUE(ReadKeptLinks(MapReader(root_.path()), {"three", "one"}).empty());
  WriteReport({{"pairs", {{{"a", "one"}, {"b", 3}}}}});
  EXPECT_THROW(ReadKeptLinks(MapReader(root_.path()), {"three", "one"}), Error);
}

}  // namespace
}  // namespace parkade
