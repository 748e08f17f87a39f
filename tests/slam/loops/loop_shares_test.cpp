#include "slam/loops/loop_shares.h"

#include <gtest/gtest.h>

namespace parkade {
namespace {

std::vector<RigKeyframe> PlacesEvery(double meters, size_t count) {
  std::vector<RigKeyframe> keyframes(count);
  for (size_t i = 0; i < count; ++i) keyframes[i].distance = meters * static_cast<double>(i);
  return keyframes;
}

LoopEvidence LoopBetween(size_t earlier, size_t later) {
  LoopEvidence loop;
  loop.earlier_keyframe = earlier;
  loop.later_keyframe = later;
  return loop;
}

TEST(LoopShares, ALoopAloneCountsWhole) {
  const std::vector<double> shares =
      SharesOf({LoopBetween(0, 20), LoopBetween(10, 29)}, PlacesEvery(2, 30), 8);
  EXPECT_DOUBLE_EQ(shares[0], 1) << "the other lies 20 m on";
  EXPECT_DOUBLE_EQ(shares[1], 1);
}

TEST(LoopShares, NeighborsCountLessAndTheNearerTheLess) {
  const std::vector<RigKeyframe> keyframes = PlacesEvery(2, 30);
  const auto share_beside = [&](size_t earlier, size_t later) {
    return SharesOf({LoopBetween(5, 20), LoopBetween(earlier, later)}, keyframes, 8)[0];
  };
  EXPECT_DOUBLE_EQ(share_beside(6, 20), 1 / (1 + kNeighborCorrelation * 0.75));
  EXPECT_LT(share_beside(6, 20), share_beside(7, 20));
  EXPECT_LT(share_beside(7, 20), share_beside(7, 22)) << "both ends count";
}

TEST(LoopShares, WhatWasNotMeasuredTakesNothingAway) {
  std::vector<LoopEvidence> loops = {LoopBetween(5, 20), LoopBetween(5, 21)};
  loops[1].pose.rejected = "too few inliers";
  EXPECT_EQ(SharesOf(loops, PlacesEvery(2, 30), 8), (std::vector<double>{1, 0}));
}

}  // namespace
}  // namespace parkade
