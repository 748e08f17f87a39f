#include "server/pipeline/kept_pairs.h"

#include <gtest/gtest.h>

#include "core/files/file.h"
#include "tests/server/store/temporary_root.h"
#include "tests/server/worlds/memory_drive.h"

namespace parkade {
namespace {

constexpr PairOfDrives kMondayTuesday{0, 1}, kMondayWednesday{0, 2}, kTuesdayWednesday{1, 2};

/// Builds of which each starts from the map of the one before.
class KeptPairsTest : public testing::Test {
 protected:
  /// \param described  of each drive: what its keyframes show
  std::vector<DriveInWork> Drives(const std::vector<std::string>& described) const {
    std::vector<DriveInWork> drives(described.size());
    for (std::size_t i = 0; i < drives.size(); ++i) {
      drives[i].log = logs_[i].get();
      drives[i].keyframes.key = described[i];
    }
    return drives;
  }

  /// What is known at the beginning of a build, which then keeps `findings`.
  PairFindings Build(const std::vector<std::string>& described, const PairFindings& findings) {
    BuildScope scope;
    if (num_maps_ > 0) scope.from = MapFolder(num_maps_ - 1);
    scope.products = MapFolder(num_maps_++);
    WriteFileAtomically(scope.products / "report.json", R"({"drives": [], "datum": null})");
    const BuildContext context(options_, scope);
    const std::vector<DriveInWork> drives = Drives(described);
    const KeptPairs pairs(context, drives);
    const PairFindings found = pairs.Find();
    pairs.Keep(findings);
    return found;
  }

  std::filesystem::path MapFolder(int number) const {
    const std::filesystem::path folder = root_.path() / std::to_string(number);
    std::filesystem::create_directories(folder);
    return folder;
  }

  MapOptions options_;

 private:
  TemporaryRoot root_;
  std::vector<std::unique_ptr<RecordedDrive>> logs_ = Logs();
  int num_maps_ = 0;

  static std::vector<std::unique_ptr<RecordedDrive>> Logs() {
    std::vector<std::unique_ptr<RecordedDrive>> logs;
    for (const char* name : {"monday", "tuesday", "wednesday"})
      logs.push_back(DriveWithoutImages(name, 1));
    return logs;
  }
};

PairFindings ThreePairs() {
  PairFindings findings;
  findings.similarities = {{kMondayTuesday, 0.5}, {kTuesdayWednesday, 0.25}};
  findings.loops[kMondayTuesday].num_agreeing = 7;
  findings.loops[kMondayWednesday].rejected = "no places in common";
  return findings;
}

TEST_F(KeptPairsTest, AreKnownToTheNextBuild) {
  EXPECT_TRUE(Build({"m", "t", "w"}, ThreePairs()).loops.empty()) << "there is no map yet";
  const PairFindings found = Build({"m", "t", "w"}, {});

  EXPECT_EQ(found.similarities, ThreePairs().similarities);
  ASSERT_EQ(found.loops.size(), 2u);
  EXPECT_EQ(found.loops.at(kMondayTuesday).num_agreeing, 7);
  EXPECT_EQ(found.loops.at(kMondayWednesday).rejected, "no places in common");
  EXPECT_TRUE(Build({"m", "t", "w"}, {}).similarities.empty()) << "the last build asked for none";
}

TEST_F(KeptPairsTest, OfDrivesThatLookOtherwiseAreForgotten) {
  Build({"m", "t", "w"}, ThreePairs());
  const PairFindings found = Build({"m", "t2", "w"}, ThreePairs());

  EXPECT_TRUE(found.similarities.empty());
  ASSERT_EQ(found.loops.size(), 1u);
  EXPECT_TRUE(found.loops.contains(kMondayWednesday));

  options_.links.min_links += 1;
  EXPECT_TRUE(Build({"m", "t2", "w"}, {}).loops.empty()) << "other options find other links";
}

TEST_F(KeptPairsTest, AFurtherDriveLeavesTheFilesOfOthersShared) {
  PairFindings findings;
  findings.similarities = {{kMondayTuesday, 0.5}};
  Build({"m", "t"}, findings);
  Build({"m", "t", "w"}, ThreePairs());
  EXPECT_EQ(std::filesystem::hard_link_count(MapFolder(0) / "tuesday/pairs.bin"), 1u)
      << "links of the pair are new";
  Build({"m", "t", "w"}, ThreePairs());

  EXPECT_EQ(std::filesystem::hard_link_count(MapFolder(1) / "tuesday/pairs.bin"), 2u);
  EXPECT_EQ(std::filesystem::hard_link_count(MapFolder(1) / "wednesday/pairs.bin"), 2u);
}

}  // namespace
}  // namespace parkade
