#include "slam/loops/reviewed_loops.h"

#include <gtest/gtest.h>

#include "core/error.h"

namespace parkade {
namespace {

LoopEvidence Loop(const std::string& id, int num_inliers, const std::string& rejected) {
  LoopEvidence loop;
  loop.id = id;
  loop.pose.num_inliers = num_inliers;
  loop.pose.information.setIdentity();
  loop.pose.rejected = rejected;
  return loop;
}

TEST(ReviewedLoops, WhatIsRejectedStaysOpen) {
  const ReviewedLoops reviewed({.rejected = {"2-40"}}, 50);
  LoopEvidence good = Loop("2-40", 80, ""), other = Loop("3-40", 80, "");
  reviewed.Judge(good);
  reviewed.Judge(other);
  EXPECT_EQ(good.pose.rejected, "rejected by the reviewer");
  EXPECT_EQ(other.pose.rejected, "");
}

TEST(ReviewedLoops, WhatIsForcedNeedsAMeasurement) {
  const ReviewedLoops reviewed({.forced = {"2-40", "3-41"}}, 50);
  LoopEvidence measured = Loop("2-40", 15, "too few inliers"),
               blind = Loop("3-41", 2, "too few inliers");
  reviewed.Judge(measured);
  reviewed.Judge(blind);
  EXPECT_TRUE(measured.is_forced);
  EXPECT_EQ(measured.pose.rejected, "");
  EXPECT_FALSE(blind.is_forced);
  EXPECT_EQ(blind.pose.rejected, "forced, but cannot be measured");
}

TEST(ReviewedLoops, AForcedLoopThatNobodyProposedIsLookedAt) {
  const ReviewedLoops reviewed({.forced = {"0-9"}}, 10);
  std::vector<bool> is_wanted(10);
  std::vector<PlaceCandidate> candidates = {{1, 8, 0.5}};

  reviewed.MarkKeyframes(is_wanted);
  reviewed.AddForced(candidates);

  EXPECT_TRUE(is_wanted[0] && is_wanted[2] && is_wanted[7] && is_wanted[9]);
  EXPECT_FALSE(is_wanted[5]);
  ASSERT_EQ(candidates.size(), 2u);
  EXPECT_EQ(candidates[1].later, 9u);
}

TEST(ReviewedLoops, NamesThatAreNoneAreRefused) {
  for (const char* id : {"", "7", "3-", "-3", "4-4", "5-4", "2-10", "2-3x", "a-b"})
    EXPECT_THROW(ReviewedLoops({.rejected = {id}}, 10), Error) << id;
  EXPECT_THROW(ReviewedLoops({.rejected = {"1-2"}, .forced = {"1-2"}}, 10), Error);
}

}  // namespace
}  // namespace parkade
