#include "server/map_folder/map_reader.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/files/file.h"
#include "server/map_folder/odometry_fingerprint.h"
#include "tests/server/store/temporary_store.h"

namespace parkade {
namespace {

using nlohmann::json;

class FinishedMapTest : public ::testing::Test {
 protected:
  MapReader Open(const json& left_out, const json& join = nullptr) {
    json report = {
        {"options", {{"odometry", {{"num_features", 300}}}}},
        {"drives", {{{"name", "kept"}, {"log", {{"sha256", "aa"}}}, {"streams", streams_}}}},
        {"left_out", left_out},
        {"datum", nullptr}};
    if (!join.is_null()) report["join"] = join;
    WriteFileAtomically(root_.path() / "report.json", report.dump());
    return MapReader(root_.path());
  }

  const json streams_ = {{{"role", "cam0"}, {"topic", "/front"}}};
  TemporaryRoot root_;
};

TEST_F(FinishedMapTest, OfADriveThatWasLeftOutItTellsHowItWasMade) {
  const MapReader map =
      Open({{{"name", "other"},
             {"reason", "no places in common"},
             {"log", {{"sha256", "bb"}}},
             {"streams", streams_},
             {"loops", {{"review", {{"rejected", {"3-9"}}, {"forced", json::array()}}}}}}});

  EXPECT_FALSE(map.Holds("other", "bb"));
  EXPECT_TRUE(map.MayBeOf("other", "bb"));
  EXPECT_FALSE(map.MayBeOf("other", "aa"));
  EXPECT_EQ(map.OdometryFingerprint("other"), map.OdometryFingerprint("kept"));
  EXPECT_EQ(map.ReviewOf("other").rejected.size(), 1u);
}

TEST_F(FinishedMapTest, WhatWasDecidedAboutLinksStays) {
  const json review = {{"rejected", {"kept:3~other:7"}}, {"forced", json::array()}};
  EXPECT_EQ(Open(json::array(), {{"review", review}}).ReviewOfLinks().rejected,
            std::vector<std::string>{"kept:3~other:7"});
  EXPECT_TRUE(Open(json::array(), {{"pairs", json::array()}}).ReviewOfLinks().rejected.empty())
      << "an older program knew of none";
  EXPECT_TRUE(Open(json::array()).ReviewOfLinks().forced.empty()) << "a drive alone";
}

TEST_F(FinishedMapTest, OfOneThatCouldNotBeTrackedItTellsNothing) {
  const MapReader map = Open({{{"name", "other"}, {"reason", "it has no cameras"}}});

  EXPECT_EQ(map.OdometryFingerprint("other"), "");
  EXPECT_EQ(map.drives(), std::vector<std::string>{"kept"});
}

TEST_F(FinishedMapTest, AHashTellsDrivesOfOneNameApart) {
  const MapReader map = Open(json::array());

  EXPECT_TRUE(map.Holds("kept", "aa"));
  EXPECT_TRUE(map.Holds("kept", "")) << "nobody says of which log it is";
  EXPECT_FALSE(map.Holds("kept", "bb"));
}

TEST_F(FinishedMapTest, AFolderWithoutAReportIsNoMap) {
  EXPECT_THROW(MapReader{root_.path()}, Error);
}

}  // namespace
}  // namespace parkade
