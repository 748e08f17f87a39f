#include "slam/sessions/settled_drives.h"

#include <gtest/gtest.h>

#include "slam/sessions/join_drives.h"
#include "tests/slam/worlds/drive_world.h"

namespace parkade {
namespace {

using Before = std::vector<std::optional<Trajectory>>;

/// Three drives of one place, joined, and a fourth that comes last.
class SettledDrivesTest : public testing::Test {
 protected:
  SettledDrivesTest() {
    for (std::uint32_t seed = 1; seed <= 4; ++seed) {
      drives_.push_back(world_.Drive(seed, seed % 2 == 0));
      to_join_.push_back(drives_.back().drive);
    }
    const DriveJoin three = JoinDrives({to_join_.begin(), to_join_.end() - 1}, {}, {});
    for (const JoinedDrive& drive : three.drives)
      before_.emplace_back(drive.site_from_body.Transformed(moved_));
    before_.emplace_back();
  }

  DriveJoin Join() const { return JoinDrives(to_join_, {}, {}, {}, {}, before_); }

  /// [m] of two drives to each other.
  double OffsetOf(const DriveJoin& join, size_t a, size_t b) const {
    return WorstOffset(drives_[a], join.drives[a].site_from_body, drives_[b],
                       join.drives[b].site_from_body);
  }

  static double Apart(const Trajectory& a, const Trajectory& b) {
    double worst = 0;
    for (size_t i = 0; i < a.states().size(); ++i)
      worst = std::max(worst, (a.states()[i].world_from_body.translation -
                               b.states()[i].world_from_body.translation)
                                  .norm());
    return worst;
  }

  const DriveWorld world_;
  const Rigid3 moved_{ExpSo3({0, 0, 0.7}), {30, 4, 2}};
  std::vector<WorldDrive> drives_;
  std::vector<DriveToJoin> to_join_;
  Before before_;
};

TEST_F(SettledDrivesTest, StayWhereTheyAreAndTheNewOneComesToThem) {
  const DriveJoin join = Join(), anew = JoinDrives(to_join_, {}, {});
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(join.drives[i].left_out, "");
    EXPECT_LT(Apart(join.drives[i].site_from_body, *before_[i]), 1e-6) << i;
    EXPECT_LT(OffsetOf(join, i, 3), OffsetOf(anew, i, 3) + 0.02) << i;
    EXPECT_LT(OffsetOf(join, i, 3), 0.08) << i;
  }
  EXPECT_LT(join.adjustment.num_links, anew.adjustment.num_links);
  for (const DrivePair& pair : join.pairs) EXPECT_GT(pair.num_accepted(), 0);
}

TEST_F(SettledDrivesTest, TheNewOneMayComeFirst) {
  std::rotate(drives_.begin(), drives_.end() - 1, drives_.end());
  std::rotate(to_join_.begin(), to_join_.end() - 1, to_join_.end());
  std::rotate(before_.begin(), before_.end() - 1, before_.end());
  const DriveJoin join = Join();
  for (size_t i = 1; i < 4; ++i) {
    EXPECT_LT(Apart(join.drives[i].site_from_body, *before_[i]), 1e-6) << i;
    EXPECT_LT(OffsetOf(join, 0, i), 0.08) << i;
  }
}

TEST_F(SettledDrivesTest, AreJoinedAnewWhereTheirLinksDoNotHoldThemTogether) {
  before_[1] = before_[1]->Transformed({Eigen::Quaterniond::Identity(), {0.5, 0, 0}});
  const DriveJoin join = Join();
  for (size_t i = 0; i < 3; ++i) EXPECT_LT(OffsetOf(join, i, 3), 0.08) << i;
  EXPECT_LT(OffsetOf(join, 0, 1), 0.08);
}

TEST_F(SettledDrivesTest, ADriveOfAnotherPlaceIsLeftOut) {
  to_join_[3] = DriveWorld({.seed = 2}).Drive(4).drive;
  const DriveJoin join = Join();
  EXPECT_EQ(join.drives[3].left_out, "no places in common");
  for (size_t i = 0; i < 3; ++i)
    EXPECT_LT(Apart(join.drives[i].site_from_body, *before_[i]), 1e-6) << i;
}

TEST_F(SettledDrivesTest, NewDrivesOfAnotherPlaceAreJoinedToEachOther) {
  const DriveWorld elsewhere({.seed = 2});
  to_join_[3] = elsewhere.Drive(4).drive;
  to_join_.push_back(elsewhere.Drive(5).drive);
  before_.emplace_back();
  const DriveJoin join = Join();
  EXPECT_GT(join.pairs.back().num_accepted(), 0);
  for (size_t i = 0; i < 3; ++i)
    EXPECT_LT(Apart(join.drives[i].site_from_body, *before_[i]), 1e-6) << i;
  for (size_t i = 3; i < 5; ++i) EXPECT_NE(join.drives[i].left_out, "");
}

TEST_F(SettledDrivesTest, TheirLinksAreWeighedByTheirErrors) {
  std::vector<DrivePair> pairs = Join().pairs;
  std::erase_if(pairs, [](const DrivePair& pair) { return pair.drive_b == 3; });
  ASSERT_FALSE(pairs.empty());
  SessionLoop& wrong = pairs[0].found.links[0];
  wrong.pose.a_from_b.translation.x() += 2;
  EXPECT_TRUE(SettledDrives(to_join_, before_).Weigh(pairs));
  EXPECT_EQ(pairs[0].weights[0], 0);
  EXPECT_GT(pairs[0].chi_squared[0], 100);
  EXPECT_GT(pairs[0].num_accepted(), static_cast<int>(pairs[0].weights.size()) * 3 / 4);
}

TEST(IsToBeSettled, WhileDrivesAreFewAndWheneverTheyAreHalfAsManyAgain) {
  for (const std::size_t now : {2, 7, 8, 12, 16, 24, 32, 48, 64})
    EXPECT_TRUE(IsToBeSettled(now - 1, now)) << now;
  for (const std::size_t now : {9, 11, 13, 20, 31, 50, 63})
    EXPECT_FALSE(IsToBeSettled(now - 1, now)) << now;
  EXPECT_TRUE(IsToBeSettled(20, 40)) << "many at once";
}

}  // namespace
}  // namespace parkade
