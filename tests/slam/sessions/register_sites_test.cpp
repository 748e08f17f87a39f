#include "slam/sessions/register_sites.h"

#include <gtest/gtest.h>

#include "tests/slam/worlds/drive_world.h"

namespace parkade {
namespace {

const Rigid3 kSiteFromWorld{ExpSo3({0, 0, 0.8}), {40, -12, 3}};

/// Keyframes where they truly lie in a site.
std::vector<RigKeyframe> KeyframesIn(const Rigid3& site_from_world, const WorldDrive& drive) {
  std::vector<RigKeyframe> keyframes = drive.drive.keyframes;
  for (size_t i = 0; i < keyframes.size(); ++i)
    keyframes[i].odom_from_keyframe = site_from_world * drive.world_from_keyframe[i];
  return keyframes;
}

TEST(RegisterSites, FindsHowTheyLieToEachOther) {
  const DriveWorld world;
  const auto found =
      RegisterSites({KeyframesIn({}, world.Drive(1))},
                    {KeyframesIn(kSiteFromWorld, world.Drive(2, /*is_opposite=*/true))}, {}, {});
  ASSERT_TRUE(found);
  const Rigid3 error = found->to_from_from * kSiteFromWorld.Inverse();
  EXPECT_LT((error * (kSiteFromWorld * Eigen::Vector3d(20, 0, 0)) -
             kSiteFromWorld * Eigen::Vector3d(20, 0, 0))
                .norm(),
            0.03);
  EXPECT_LT(LogSo3(error.rotation).norm(), 0.002);
  EXPECT_GT(found->num_links, 15U);
  EXPECT_LT(found->horizontal_sigma, 0.05);
  EXPECT_LT(found->height_sigma, 0.05);
}

TEST(RegisterSites, OneDriveThatLiesWrongInItsSiteDoesNotMoveTheRest) {
  const DriveWorld world;
  const Rigid3 shifted{Eigen::Quaterniond::Identity(), {0, 2, 0}};
  const std::vector<std::vector<RigKeyframe>> from = {KeyframesIn({}, world.Drive(1)),
                                                      KeyframesIn({}, world.Drive(2)),
                                                      KeyframesIn(shifted, world.Drive(3))};
  const auto found = RegisterSites(from, {KeyframesIn(kSiteFromWorld, world.Drive(4))}, {}, {});
  ASSERT_TRUE(found);
  const Eigen::Vector3d middle(20, 0, 0);
  EXPECT_LT((found->to_from_from * middle - kSiteFromWorld * middle).norm(), 0.06);
}

TEST(RegisterSites, SitesThatContradictEachOtherAreNotRegistered) {
  const DriveWorld world;
  const Rigid3 shifted{Eigen::Quaterniond::Identity(), {0, 2, 0}};
  const std::vector<std::vector<RigKeyframe>> from = {KeyframesIn({}, world.Drive(1)),
                                                      KeyframesIn(shifted, world.Drive(2))};
  EXPECT_FALSE(RegisterSites(from, {KeyframesIn({}, world.Drive(3))}, {}, {}));
}

TEST(RegisterSites, AnotherPlaceIsNot) {
  const std::vector<RigKeyframe> here = KeyframesIn({}, DriveWorld({.seed = 1}).Drive(1));
  const std::vector<RigKeyframe> there = KeyframesIn({}, DriveWorld({.seed = 2}).Drive(2));
  EXPECT_FALSE(RegisterSites({here}, {there}, {}, {}));
  EXPECT_FALSE(RegisterSites({here}, {}, {}, {}));
}

TEST(RegisterSites, WhereTheyLieOnEarthKeepsApartWhatLooksAlike) {
  const DriveWorld world;
  const std::vector<RigKeyframe> here = KeyframesIn({}, world.Drive(1)),
                                 there = KeyframesIn({}, world.Drive(2));
  const SitePrior elsewhere{Rigid3{Eigen::Quaterniond::Identity(), {0, 200, 0}}, 2};
  EXPECT_FALSE(RegisterSites({here}, {there}, {}, {}, elsewhere));
  EXPECT_TRUE(RegisterSites({here}, {there}, {}, {}, SitePrior{{}, 2}));
}

}  // namespace
}  // namespace parkade
