#include "mapping/kerbs/kerb_lines.h"

#include <gtest/gtest.h>

#include <cmath>

namespace parkade {
namespace {

constexpr int kNumStrips = 30;

/// An outline along x, a strip per half a meter; kerbs of 11 and 12 cm are known up to strip 10.
struct Outline {
  std::vector<OutlineStrip> strips;
  std::vector<KerbLook> looks = std::vector<KerbLook>(kNumStrips, KerbLook::kUnknown);
  std::vector<std::optional<KerbStep>> steps = std::vector<std::optional<KerbStep>>(kNumStrips);
  std::vector<bool> is_kerb = std::vector<bool>(kNumStrips);

  Outline() {
    for (int i = 0; i < kNumStrips; ++i) {
      strips.push_back(
          {.ring = 0, .index = i, .ring_size = 100, .foot = {0.5 * i, 0, 0}, .along = {1, 0}});
      if (i > 10) continue;
      steps[static_cast<std::size_t>(i)] = KerbStep{i % 2 == 0 ? 0.11 : 0.12, 0.01};
      is_kerb[static_cast<std::size_t>(i)] = true;
    }
  }
  void Continue() {
    StripsAlong along;
    for (std::size_t i = 0; i < strips.size(); ++i) along[{strips[i].ring, strips[i].index}] = i;
    ContinueLines(strips, looks, along, 0.04, steps, is_kerb);
  }
};

TEST(ContinueLines, AStripOnTheLineOfAKerbIsOneAndAsHigh) {
  Outline outline;
  outline.Continue();
  EXPECT_TRUE(outline.is_kerb[20]);
  ASSERT_TRUE(outline.steps[20]);
  EXPECT_NEAR(outline.steps[20]->height, 0.115, 0.006);
  EXPECT_DOUBLE_EQ(outline.steps[20]->sigma, 0.02);
}

TEST(ContinueLines, WhatIsSeenToBeSomethingElseStaysThat) {
  Outline outline;
  outline.looks[15] = KerbLook::kNone;
  outline.steps[16] = KerbStep{0.01, 0.005};  // a dropped kerb
  outline.steps[17] = KerbStep{0.31, 0.01};   // the sill of a car
  outline.Continue();
  for (const std::size_t i : {15U, 16U, 17U}) EXPECT_FALSE(outline.is_kerb[i]) << i;
  EXPECT_DOUBLE_EQ(outline.steps[16]->height, 0.01);
  EXPECT_TRUE(outline.is_kerb[18]);
}

TEST(ContinueLines, StripsOffTheLineOrAcrossItAreNone) {
  Outline outline;
  outline.strips[13].foot.y() = 0.6;
  outline.strips[14].along = {0.8, 0.6};
  outline.strips[15].along = {-1, 0};  // the other side of something
  outline.strips[16].foot.z() = 2.8;   // another deck
  outline.Continue();
  for (const std::size_t i : {13U, 14U, 15U, 16U}) EXPECT_FALSE(outline.is_kerb[i]) << i;
}

TEST(ContinueLines, ACurveHasNoLineAndFewStripsMakeNone) {
  Outline round, shorter;
  for (int i = 0; i <= 10; ++i) {
    const double angle = 0.5 * (i - 10) / 3.0;  // of 3 m radius, which ends along x
    auto& strip = round.strips[static_cast<std::size_t>(i)];
    strip.foot = {5 + 3 * std::sin(angle), 3 - 3 * std::cos(angle), 0};
    strip.along = {std::cos(angle), std::sin(angle)};
    if (i < 6) shorter.is_kerb[static_cast<std::size_t>(i)] = false;
  }
  round.Continue();
  shorter.Continue();
  EXPECT_FALSE(round.is_kerb[20]);
  EXPECT_FALSE(shorter.is_kerb[20]);
}

}  // namespace
}  // namespace parkade
