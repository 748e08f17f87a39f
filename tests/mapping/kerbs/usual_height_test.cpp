#include "mapping/kerbs/usual_height.h"

#include <gtest/gtest.h>

#include <cmath>

namespace parkade {
namespace {

/// 10 m at `x`.
Kerb KerbAt(double x, double height, double sigma) {
  Kerb kerb;
  kerb.points = {{x, 0, 0}, {x + 5, 0, 0}, {x + 10, 0, 0}};
  kerb.height = height;
  kerb.height_sigma = sigma;
  return kerb;
}

TEST(LeanOnNeighbors, AKerbThatWasHardlyMeasuredIsAsHighAsThoseNearby) {
  std::vector<Kerb> kerbs = {KerbAt(0, 0.18, 0.01), KerbAt(15, 0.182, 0.012),
                             KerbAt(30, 0.12, 0.04)};
  LeanOnNeighbors(kerbs);
  EXPECT_NEAR(kerbs[2].height, 0.18, 0.001) << "0.12 +- 0.04 is what is usual anywhere";
  EXPECT_NEAR(kerbs[2].height_sigma, 0.02, 0.001);
  EXPECT_EQ(kerbs[0].height, 0.18) << "what was measured stays";
  EXPECT_EQ(kerbs[1].height_sigma, 0.012);
}

TEST(LeanOnNeighbors, WhereTheyDisagreeTheySayLittle) {
  std::vector<Kerb> kerbs = {KerbAt(0, 0.06, 0.01), KerbAt(15, 0.18, 0.01), KerbAt(30, 0.06, 0.01),
                             KerbAt(45, 0.18, 0.01), KerbAt(20, 0.12, 0.04)};
  LeanOnNeighbors(kerbs);
  EXPECT_GT(kerbs[4].height_sigma, 0.08);
}

TEST(LeanOnNeighbors, WhatWasSeenOfItCounts) {
  std::vector<Kerb> kerbs = {KerbAt(0, 0.06, 0.01), KerbAt(20, 0.1, 0.025)};
  LeanOnNeighbors(kerbs);
  // 0.1 +- 0.025 without 0.12 +- 0.04 is 0.087 +- 0.032; nearby they are 0.06 +- 0.0235.
  EXPECT_NEAR(kerbs[1].height, 0.0695, 0.001);
  EXPECT_NEAR(kerbs[1].height_sigma, 0.019, 0.0005);
}

/// As one of 12 m was measured on a street of low kerbs.
TEST(LeanOnNeighbors, ALongOneThatIsWrongOutvotesNoneThatKnowBetter) {
  std::vector<Kerb> kerbs = {KerbAt(0, 0.133, 0.0194), KerbAt(15, 0.05, 0.0096),
                             KerbAt(30, 0.0485, 0.0145), KerbAt(45, 0.0585, 0.035)};
  kerbs[0].points.emplace_back(50, 0, 0);
  LeanOnNeighbors(kerbs);
  EXPECT_LT(kerbs[0].height, 0.1);
  EXPECT_LT(std::abs(kerbs[0].height - 0.05), 1.5 * kerbs[0].height_sigma);
  EXPECT_EQ(kerbs[1].height, 0.05) << "known better than kerbs differ";
  EXPECT_EQ(kerbs[2].height, 0.0485);
  EXPECT_NEAR(kerbs[3].height, 0.05, 0.01);
}

TEST(LeanOnNeighbors, SureOnesCountMoreThanVagueOnes) {
  std::vector<Kerb> kerbs = {KerbAt(0, 0.15, 0.0199), KerbAt(10, 0.15, 0.0199),
                             KerbAt(20, 0.05, 0.001), KerbAt(30, 0.05, 0.001),
                             KerbAt(40, 0.12, 0.04)};
  LeanOnNeighbors(kerbs);
  EXPECT_NEAR(kerbs[4].height, 0.05, 0.001);
  EXPECT_GT(kerbs[4].height_sigma, 0.05) << "the others may be right";
}

TEST(LeanOnNeighbors, ALoweredKerbIsNotSureToBeAsHighAsTheOthers) {
  std::vector<Kerb> kerbs = {KerbAt(0, 0.12, 0.01), KerbAt(15, 0.12, 0.01), KerbAt(30, 0.12, 0.01),
                             KerbAt(45, 0.03, 0.018)};
  LeanOnNeighbors(kerbs);
  EXPECT_LT(kerbs[3].height, 0.08);
  EXPECT_LT(kerbs[3].height - 0.03, 1.2 * kerbs[3].height_sigma);
}

TEST(LeanOnNeighbors, ItStaysBetweenWhatWasSeenAndWhatIsUsualNearby) {
  std::vector<Kerb> kerbs = {KerbAt(0, 0.05, 0.01), KerbAt(15, 0.05, 0.01), KerbAt(30, 0.14, 0.01),
                             KerbAt(45, 0.05, 0.025)};
  LeanOnNeighbors(kerbs);
  EXPECT_EQ(kerbs[3].height, 0.05);
}

TEST(LeanOnNeighbors, AKerbStaysAsItIsWhereNobodyKnowsBetter) {
  std::vector<Kerb> kerbs = {KerbAt(0, 0.12, 0.04), KerbAt(15, 0.13, 0.03),
                             KerbAt(200, 0.06, 0.01)};
  LeanOnNeighbors(kerbs);
  EXPECT_EQ(kerbs[0].height, 0.12);
  EXPECT_EQ(kerbs[1].height, 0.13);
}

}  // namespace
}  // namespace parkade
