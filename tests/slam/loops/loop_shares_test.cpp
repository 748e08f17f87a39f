#include "slam/loops/loop_shares.h"

#include <gtest/gtest.h>

namespace parkade {
namespace {

std::vector<Place> PlacesEvery(double metres, size_t count) {
  std::vector<Place> places(count);
  for (size_t i = 0; i < count; ++i) places[i].distance = metres * static_cast<double>(i);
  return places;
}

LoopEvidence LoopBetween(size_t earlier, size_t later) {
  LoopEvidence loop;
  loop.earlier_place = earlier;
  loop.later_place = later;
  return loop;
}

TEST(LoopShares, ALoopAloneCountsWhole) {
  const std::vector<double> shares = SharesOf({LoopBetween(0, 20), LoopBetween(10, 29)}, PlacesEvery(2, 30), 8);
  EXPECT_DOUBLE_EQ(shares[0], 1) << "the other lies 20 m on";
  EXPECT_DOUBLE_EQ(shares[1], 1);
}

TEST(LoopShares, NeighboursCountLessAndTheNearerTheLess) {
  const std::vector<Place> places = PlacesEvery(2, 30);
  const auto share_beside = [&](size_t earlier, size_t later) {
    return SharesOf({LoopBetween(5, 20), LoopBetween(earlier, later)}, places, 8)[0];
  };
  EXPECT_DOUBLE_EQ(share_beside(6, 20), 1 / (1 + kNeighbourCorrelation * 0.75));
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
