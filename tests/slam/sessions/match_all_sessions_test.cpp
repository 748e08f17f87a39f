#include "slam/sessions/match_all_sessions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "tests/slam/worlds/drive_world.h"

namespace parkade {
namespace {

std::vector<DriveToJoin> DrivesOf(const DriveWorld& world, std::uint32_t first_seed,
                                  std::uint32_t count) {
  std::vector<DriveToJoin> drives;
  for (std::uint32_t i = 0; i < count; ++i) drives.push_back(world.Drive(first_seed + i).drive);
  return drives;
}

TEST(MatchAllSessions, OfManyDrivesOnlyAlikeOnesAreLinkedAndAllHangTogether) {
  const std::vector<DriveToJoin> drives = DrivesOf(DriveWorld(), 1, 5);
  const std::vector<DrivePair> pairs =
      MatchAllSessions(drives, {}, {.all_pairs_up_to = 3, .partners = 1}).pairs;
  EXPECT_LE(pairs.size(), 7u) << "of 10: each drive's partner, and what joins groups";
  EXPECT_EQ(FindGroups(drives.size(), pairs), std::vector<size_t>(5, 0));
  EXPECT_TRUE(
      std::is_sorted(pairs.begin(), pairs.end(), [](const DrivePair& x, const DrivePair& y) {
        return std::pair(x.drive_b, x.drive_a) < std::pair(y.drive_b, y.drive_a);
      }));
}

TEST(MatchAllSessions, OneMoreDriveCostsItsOwnPairsOnly) {
  std::vector<DriveToJoin> drives = DrivesOf(DriveWorld(), 1, 4);
  const SessionLoopOptions options = {.all_pairs_up_to = 2, .partners = 1};
  const PairFindings of_four = MatchAllSessions(drives, {}, options).findings;
  EXPECT_EQ(of_four.similarities.size(), 6u);

  drives.push_back(DriveWorld().Drive(5).drive);
  const MatchedSessions five = MatchAllSessions(drives, {}, options, of_four);
  EXPECT_EQ(five.findings.similarities.size(), 6u + 4u);
  EXPECT_LE(std::count_if(five.findings.loops.begin(), five.findings.loops.end(),
                          [&](const auto& pair) { return !of_four.loops.contains(pair.first); }),
            4);
  EXPECT_EQ(FindGroups(drives.size(), five.pairs), std::vector<size_t>(5, 0));

  // What is known is what is found anew.
  const std::vector<DrivePair> again = MatchAllSessions(drives, {}, options, five.findings).pairs;
  const std::vector<DrivePair> afresh = MatchAllSessions(drives, {}, options).pairs;
  ASSERT_EQ(again.size(), afresh.size());
  for (size_t i = 0; i < again.size(); ++i) {
    EXPECT_EQ(again[i].drive_a, afresh[i].drive_a);
    ASSERT_EQ(again[i].found.links.size(), afresh[i].found.links.size());
    for (size_t k = 0; k < again[i].found.links.size(); ++k)
      EXPECT_EQ(again[i].found.links[k].pose.a_from_b.Matrix(),
                afresh[i].found.links[k].pose.a_from_b.Matrix());
  }
}

TEST(MatchAllSessions, DrivesThatAreDescribedWhenAskedAreLinkedAlikeAndFewAreAsked) {
  std::vector<DriveToJoin> drives = DrivesOf(DriveWorld(), 1, 5);
  const SessionLoopOptions options = {.all_pairs_up_to = 2, .partners = 1};
  PairFindings known = MatchAllSessions({drives.begin(), drives.end() - 1}, {}, options).findings;
  const MatchedSessions whole = MatchAllSessions(drives, {}, options, known);

  std::vector<DriveToJoin> bare = drives;
  std::set<size_t> asked;
  for (size_t i = 0; i + 1 < bare.size(); ++i) {
    bare[i].words = PlaceWords(bare[i].keyframes);
    for (RigKeyframe& keyframe : bare[i].keyframes) {
      keyframe.features.clear();
      keyframe.descriptors = cv::Mat();
    }
    bare[i].describe = [&, i] {
      EXPECT_TRUE(asked.insert(i).second) << "described twice";
      return drives[i].keyframes;
    };
  }
  const MatchedSessions matched = MatchAllSessions(bare, {}, options, known);

  EXPECT_EQ(matched.findings.similarities, whole.findings.similarities);
  ASSERT_EQ(matched.pairs.size(), whole.pairs.size());
  for (size_t i = 0; i < matched.pairs.size(); ++i) {
    const std::vector<SessionLoop>&links = matched.pairs[i].found.links,
          &expected = whole.pairs[i].found.links;
    ASSERT_EQ(links.size(), expected.size());
    for (size_t k = 0; k < links.size(); ++k)
      EXPECT_EQ(links[k].pose.a_from_b.Matrix(), expected[k].pose.a_from_b.Matrix());
  }
  EXPECT_GT(asked.size(), 0u);
  EXPECT_LT(asked.size(), 4u) << "those without new links are not described";
}

TEST(MatchAllSessions, ADriveOfAnotherPlaceStaysApart) {
  std::vector<DriveToJoin> drives = DrivesOf(DriveWorld(), 1, 3);
  drives.push_back(DriveWorld({.seed = 2}).Drive(4).drive);
  const std::vector<DrivePair> pairs =
      MatchAllSessions(drives, {}, {.all_pairs_up_to = 2, .partners = 1}).pairs;
  EXPECT_EQ(FindGroups(drives.size(), pairs), (std::vector<size_t>{0, 0, 0, 3}));
}

TEST(SimilarityOf, TellsDrivesOfOnePlaceFromThoseOfAnother) {
  const DriveWorld world, elsewhere({.seed = 2});
  const std::vector<RigKeyframe> keyframes = world.Drive(1).drive.keyframes,
                                 back = world.Drive(2, true).drive.keyframes,
                                 there = world.Drive(2).drive.keyframes,
                                 apart = elsewhere.Drive(3).drive.keyframes;
  const ComparedDrive drive(keyframes);
  const double same = SimilarityOf(drive, ComparedDrive(back), {});
  const double other = SimilarityOf(drive, ComparedDrive(apart), {});
  EXPECT_GT(same, 3 * other);
  EXPECT_LE(same, 1);
  EXPECT_EQ(SimilarityOf(drive, ComparedDrive(there), {},
                         Rigid3{Eigen::Quaterniond::Identity(), {500, 0, 0}}),
            0);
}

}  // namespace
}  // namespace parkade
