#include "slam/sessions/join_drives.h"

#include <gtest/gtest.h>

#include "slam/sessions/consistent_loops.h"
#include "tests/slam/worlds/drive_world.h"

namespace parkade {
namespace {

SessionLoops Link(const WorldDrive& a, const WorldDrive& b) {
  return MatchSessions(a.drive.keyframes, b.drive.keyframes, {}, RelativePoseOptions{});
}

double WorstLink(const WorldDrive& a, const WorldDrive& b, const std::vector<SessionLoop>& links) {
  double worst = 0;
  for (const SessionLoop& link : links) {
    const Rigid3 truth =
        a.world_from_keyframe[link.keyframe_a].Inverse() * b.world_from_keyframe[link.keyframe_b];
    worst = std::max(worst, (truth.translation - link.pose.a_from_b.translation).norm());
  }
  return worst;
}

TEST(MatchSessions, FindsWhereDrivesPassEachOther) {
  const DriveWorld world;
  const WorldDrive a = world.Drive(1), b = world.Drive(2);
  const SessionLoops found = Link(a, b);
  EXPECT_EQ(found.rejected, "");
  EXPECT_GT(found.links.size(), 15u);
  EXPECT_LT(WorstLink(a, b, found.links), 0.15);
}

TEST(MeasureLink, WhatIsForetoldIsMeasuredAsWell) {
  const DriveWorld world;
  const WorldDrive a = world.Drive(1), b = world.Drive(2);
  for (const size_t i : {4U, 9U, 14U}) {
    const Rigid3 truth = a.world_from_keyframe[i].Inverse() * b.world_from_keyframe[i];
    const Rigid3 foretold = truth * Rigid3{Eigen::Quaterniond::Identity(), {0.08, -0.08, 0}};
    const auto measure = [&](const std::optional<Rigid3>& pose) {
      return MeasureLink(a.drive.keyframes, b.drive.keyframes, {i, i, 0}, {}, {}, pose).pose;
    };
    const RelativePose from_nothing = measure({}), from_there = measure(foretold);
    EXPECT_EQ(from_there.rejected, "");
    EXPECT_GE(from_there.num_inliers, from_nothing.num_inliers * 9 / 10);
    EXPECT_LT((from_there.a_from_b.translation - from_nothing.a_from_b.translation).norm(), 0.01);
    const RelativePose misled = measure(truth * Rigid3{Eigen::Quaterniond::Identity(), {6, 0, 0}});
    if (misled.rejected.empty()) {
      EXPECT_LT((misled.a_from_b.translation - from_nothing.a_from_b.translation).norm(), 0.01);
    }
  }
}

TEST(MatchSessions, TheOtherWayAroundIsNoHindrance) {
  const DriveWorld world;
  const WorldDrive a = world.Drive(1), b = world.Drive(2, /*is_opposite=*/true);
  const SessionLoops found = Link(a, b);
  EXPECT_GT(found.links.size(), 15u) << found.rejected;
  EXPECT_LT(WorstLink(a, b, found.links), 0.15);
}

TEST(MatchSessions, AnotherPlaceHasNoLinks) {
  const WorldDrive a = DriveWorld({.seed = 1}).Drive(1), b = DriveWorld({.seed = 2}).Drive(2);
  const SessionLoops found = Link(a, b);
  EXPECT_TRUE(found.links.empty());
  EXPECT_EQ(found.rejected, "no places in common");
}

TEST(MatchSessions, DecksThatLookQuiteTheSameAreAmbiguous) {
  const DriveWorld world({.num_decks = 2, .shared_looks = 1});
  const SessionLoops found = Link(world.Drive(1, false, {0, 1}), world.Drive(2, false, {1}));
  EXPECT_TRUE(found.links.empty());
  EXPECT_EQ(found.rejected, "ambiguous: other links agree on another pose");
}

TEST(MatchSessions, DecksAreToldApartByWhatDiffers) {
  const DriveWorld world({.num_decks = 2, .shared_looks = 0.5});
  const WorldDrive a = world.Drive(1, false, {0, 1}), b = world.Drive(2, false, {1});
  const SessionLoops found = Link(a, b);
  EXPECT_GT(found.links.size(), 15u) << found.rejected;
  EXPECT_LT(WorstLink(a, b, found.links), 0.15);
}

TEST(MatchSessions, BuildingsThatLookAlikeAreToldApartByTheirFloors) {
  const std::vector<RigKeyframe> here = DriveWorld({.floor_seed = 1}).Drive(1).drive.keyframes;
  const SessionLoops twins =
      MatchSessions(here, DriveWorld({.floor_seed = 2}).Drive(2).drive.keyframes, {}, {});
  EXPECT_TRUE(twins.links.empty());
  EXPECT_EQ(twins.rejected, "the floor is another one");
  EXPECT_GT(twins.num_agreeing, 10);
  const SessionLoops same =
      MatchSessions(here, DriveWorld({.floor_seed = 1}).Drive(2, true).drive.keyframes, {}, {});
  EXPECT_GT(same.links.size(), 10U);
  EXPECT_GT(same.floor.across.share(), 0.8);
}

TEST(MatchSessions, AFloorThatNobodySawTellsNothing) {
  const std::vector<RigKeyframe> here = DriveWorld({.floor_seed = 1}).Drive(1).drive.keyframes;
  EXPECT_GT(MatchSessions(here, DriveWorld().Drive(2).drive.keyframes, {}, {}).links.size(), 10U);
}

TEST(MatchSessions, GnssKeepsApartWhatItPutsFarApart) {
  const DriveWorld world;
  const WorldDrive a = world.Drive(1), b = world.Drive(2);
  const Rigid3 truth = a.drive.keyframes[0].odom_from_keyframe *
                       a.world_from_keyframe[0].Inverse() * b.world_from_keyframe[0] *
                       b.drive.keyframes[0].odom_from_keyframe.Inverse();
  const Rigid3 elsewhere = Rigid3{Eigen::Quaterniond::Identity(), {0, 200, 0}} * truth;
  EXPECT_FALSE(
      MatchSessions(a.drive.keyframes, b.drive.keyframes, {}, {}, truth, 1.0).links.empty());
  EXPECT_TRUE(
      MatchSessions(a.drive.keyframes, b.drive.keyframes, {}, {}, elsewhere, 1.0).links.empty());
}

TEST(FindConsistentLoops, WrongLinksAgreeWithNothing) {
  const DriveWorld world;
  const WorldDrive a = world.Drive(1), b = world.Drive(2);
  std::vector<SessionLoop> links;
  for (size_t i = 0; i < 20; ++i) {
    SessionLoop link{i, i, 0, {}};
    link.pose.a_from_b = a.world_from_keyframe[i].Inverse() * b.world_from_keyframe[i];
    link.pose.worst_sigma = 0.02;
    if (i % 2 == 1)  // wrong by meters, each in its own way
      link.pose.a_from_b.translation +=
          1.5 * Eigen::Vector3d(std::sin(7.0 * double(i)), std::cos(5.0 * double(i)), 0.3);
    links.push_back(link);
  }
  const std::vector<size_t> expected = {0, 2, 4, 6, 8, 10, 12, 14, 16, 18};
  EXPECT_EQ(FindConsistentLoops(a.drive.keyframes, b.drive.keyframes, links, {}), expected);
}

TEST(JoinDrives, ThreeDrivesOfOnePlaceComeTogether) {
  const DriveWorld world;
  const std::vector<WorldDrive> drives = {world.Drive(1), world.Drive(2, true), world.Drive(3)};
  const DriveJoin join = JoinDrives({drives[0].drive, drives[1].drive, drives[2].drive}, {}, {});
  for (size_t i = 0; i < 3; ++i) ASSERT_EQ(join.drives[i].left_out, "") << i;
  EXPECT_LT(WorstOffset(drives[0], join.drives[0].site_from_body, drives[1],
                        join.drives[1].site_from_body),
            0.08);
  EXPECT_LT(WorstOffset(drives[1], join.drives[1].site_from_body, drives[2],
                        join.drives[2].site_from_body),
            0.08);
}

TEST(JoinDrives, ADriveOfAnotherPlaceIsLeftOut) {
  const DriveWorld world({.seed = 1}), elsewhere({.seed = 2});
  const DriveJoin join =
      JoinDrives({world.Drive(1).drive, elsewhere.Drive(2).drive, world.Drive(3).drive}, {}, {});
  EXPECT_EQ(join.drives[0].left_out, "");
  EXPECT_EQ(join.drives[1].left_out, "no places in common");
  EXPECT_TRUE(join.drives[1].site_from_body.empty());
  EXPECT_EQ(join.drives[2].left_out, "");
}

/// GNSS that puts a drive's frame there, to sigma [m].
GnssAlignment Fix(const Rigid3& site_from_odom, double sigma) {
  GnssAlignment gnss;
  gnss.site_from_odom = site_from_odom;
  gnss.covariance.diagonal() << 1e-4, sigma * sigma, sigma * sigma, sigma * sigma;
  gnss.extent = 30;
  return gnss;
}

TEST(JoinDrives, GnssPlacesTheSiteAndLinksTheDrivesWithinIt) {
  const DriveWorld world;
  WorldDrive a = world.Drive(1), b = world.Drive(2);
  const auto frame_of = [](const WorldDrive& drive) {
    return drive.world_from_keyframe[10] * drive.drive.keyframes[10].odom_from_keyframe.Inverse();
  };
  a.drive.gnss = Fix(Rigid3{Eigen::Quaterniond::Identity(), {0.6, 0, 0}} * frame_of(a), 0.5);
  b.drive.gnss = Fix(Rigid3{Eigen::Quaterniond::Identity(), {0, -0.6, 0}} * frame_of(b), 0.5);
  const DriveJoin join = JoinDrives({a.drive, b.drive}, {}, {});
  const Eigen::Vector3d in_site =
      join.drives[0].site_from_body.states()[10].world_from_body.translation;
  EXPECT_LT(
      (in_site - a.world_from_keyframe[10].translation - Eigen::Vector3d(0.3, -0.3, 0)).norm(),
      0.1);
  EXPECT_LT(WorstOffset(a, join.drives[0].site_from_body, b, join.drives[1].site_from_body), 0.08);
  for (const JoinedDrive& drive : join.drives) EXPECT_FALSE(drive.is_held_by_gnss_alone);
}

TEST(JoinDrives, GnssThatIsOffBendsNothing) {
  const DriveWorld world;
  std::vector<WorldDrive> drives = {world.Drive(1), world.Drive(2, true), world.Drive(3)};
  double off = 0.1;  // [rad], and that many times 10 m
  for (WorldDrive& drive : drives) {
    const Rigid3 true_frame =
        drive.world_from_keyframe[10] * drive.drive.keyframes[10].odom_from_keyframe.Inverse();
    drive.drive.gnss =
        Fix(Rigid3{ExpSo3({0, 0, off}), {10 * off, -5 * off, 5 * off}} * true_frame, 0.8);
    off *= -1.2;
  }
  const DriveJoin join = JoinDrives({drives[0].drive, drives[1].drive, drives[2].drive}, {}, {});
  for (size_t i = 1; i < 3; ++i) {
    ASSERT_EQ(join.drives[i].left_out, "");
    EXPECT_LT(WorstOffset(drives[i - 1], join.drives[i - 1].site_from_body, drives[i],
                          join.drives[i].site_from_body),
              0.08);
  }
}

TEST(JoinDrives, DrivesOfAnotherPlaceThatFitEachOtherAreLeftOutForTheRightReason) {
  const DriveWorld here({.seed = 1}), there({.seed = 2});
  const DriveJoin join = JoinDrives({there.Drive(4).drive, here.Drive(1).drive, here.Drive(2).drive,
                                     here.Drive(3).drive, there.Drive(5).drive},
                                    {}, {});
  for (const size_t kept : {1, 2, 3}) EXPECT_EQ(join.drives[kept].left_out, "");
  for (const size_t foreign : {0, 4})
    EXPECT_EQ(join.drives[foreign].left_out, "no places in common");
}

TEST(JoinDrives, GnssAloneHoldsDrivesTogetherThatShareNoPlace) {
  WorldDrive a = DriveWorld({.seed = 1}).Drive(1), b = DriveWorld({.seed = 2}).Drive(2);
  a.drive.gnss = Fix({Eigen::Quaterniond::Identity(), {0, 0, 0}}, 0.02);
  b.drive.gnss = Fix({Eigen::Quaterniond::Identity(), {0, 100, 0}}, 0.02);
  const DriveJoin join = JoinDrives({a.drive, b.drive}, {}, {});
  EXPECT_EQ(join.drives[0].left_out + join.drives[1].left_out, "");
  const Eigen::Vector3d expected =
      Eigen::Vector3d(0, 100, 0) + b.drive.keyframes[10].odom_from_keyframe.translation;
  EXPECT_LT(
      (join.drives[1].site_from_body.states()[10].world_from_body.translation - expected).norm(),
      0.05);
  EXPECT_FALSE(join.drives[0].is_held_by_gnss_alone);
  EXPECT_TRUE(join.drives[1].is_held_by_gnss_alone);
}

TEST(JoinDrives, OneDriveStaysWhereItIs) {
  const WorldDrive a = DriveWorld().Drive(1);
  const DriveJoin join = JoinDrives({a.drive}, {}, {});
  EXPECT_EQ(join.drives[0].site_from_body.states()[3].world_from_body.translation,
            a.drive.odom_from_body.states()[3].world_from_body.translation);
}

}  // namespace
}  // namespace parkade
