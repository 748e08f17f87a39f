#include "mapping/baselines/segment_by_color.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "mapping/baselines/road_colors.h"
#include "tests/mapping/worlds/fan_grid.h"

namespace parkade {
namespace {

class ColorsOnAFan : public testing::Test {
 protected:
  ColorsOnAFan() : colors_(kRays, kRanges, CV_8UC3, cv::Scalar(90, 92, 91)) {
    cv::RNG random(7);
    for (int i = 0; i < kRays * kRanges; ++i) {
      const auto noise = static_cast<uchar>(random.uniform(0, 8));
      colors_.at<cv::Vec3b>(i / kRanges, i % kRanges) += cv::Vec3b(noise, noise, noise);
    }
    seeds_.assign(grid_.cells.size(), 0);
    for (int ray = 20; ray < 40; ++ray)
      for (int range = 0; range < 10; ++range)
        seeds_[static_cast<size_t>(grid_.IndexOf(ray, range))] = 1;
  }

  void Paint(int first_ray, int first_range, int num_rays, int num_ranges,
             const cv::Scalar& color) {
    colors_(cv::Rect(first_range, first_ray, num_ranges, num_rays)).setTo(color);
  }
  GroundLabel At(const std::vector<GroundLabel>& labels, int ray, int range) const {
    return labels[static_cast<size_t>(grid_.IndexOf(ray, range))];
  }

  GroundGrid grid_ = MakeFan();
  cv::Mat colors_;
  std::vector<std::uint8_t> seeds_;
};

TEST_F(ColorsOnAFan, ARoadOfOneColorIsGroundThroughout) {
  const std::vector<GroundLabel> labels = SegmentByColor(grid_, colors_, seeds_);

  EXPECT_GT(std::count(labels.begin(), labels.end(), GroundLabel::kGround),
            kRays * kRanges * 98 / 100);
}

TEST_F(ColorsOnAFan, ARedCarIsNotGround) {
  Paint(25, 40, 12, 40, {30, 30, 170});

  const std::vector<GroundLabel> labels = SegmentByColor(grid_, colors_, seeds_);

  for (int ray = 27; ray < 35; ++ray)
    for (int range = 42; range < 78; ++range)
      EXPECT_EQ(At(labels, ray, range), GroundLabel::kNotGround);
  EXPECT_EQ(At(labels, 10, 60), GroundLabel::kGround);
}

TEST_F(ColorsOnAFan, AThinWhiteLineWithRoadOnBothSidesIsPaint) {
  Paint(0, 40, kRays - 10, 2, {225, 225, 225});

  const std::vector<GroundLabel> labels = SegmentByColor(grid_, colors_, seeds_);

  EXPECT_EQ(At(labels, 30, 40), GroundLabel::kGround);
  EXPECT_EQ(At(labels, 30, 70), GroundLabel::kGround);
}

TEST_F(ColorsOnAFan, WhatAWhiteKerbEnclosesIsNotReached) {
  Paint(0, 40, kRays, 2, {225, 225, 225});

  const std::vector<GroundLabel> labels = SegmentByColor(grid_, colors_, seeds_);

  EXPECT_EQ(At(labels, 30, 20), GroundLabel::kGround);
  EXPECT_EQ(At(labels, 30, 70), GroundLabel::kNotGround);
}

TEST_F(ColorsOnAFan, AThinBlackGapIsNotPaint) {
  Paint(0, 40, kRays, 3, {10, 10, 10});

  const std::vector<GroundLabel> labels = SegmentByColor(grid_, colors_, seeds_);

  EXPECT_EQ(At(labels, 30, 41), GroundLabel::kNotGround);
  EXPECT_EQ(At(labels, 30, 70), GroundLabel::kNotGround) << "nothing leads there";
}

TEST_F(ColorsOnAFan, RoadInShadeIsGroundWhenTheSeedsShowBoth) {
  Paint(0, 0, kRays, kRanges, {90, 92, 91});
  Paint(30, 0, 30, kRanges, {50, 48, 46});

  const std::vector<GroundLabel> labels = SegmentByColor(grid_, colors_, seeds_);

  EXPECT_EQ(At(labels, 10, 60), GroundLabel::kGround);
  EXPECT_EQ(At(labels, 50, 60), GroundLabel::kGround);
}

TEST_F(ColorsOnAFan, WithoutSeedsNothingIsCalledGround) {
  const std::vector<GroundLabel> labels =
      SegmentByColor(grid_, colors_, std::vector<std::uint8_t>(grid_.cells.size()));

  EXPECT_EQ(std::count(labels.begin(), labels.end(), GroundLabel::kUnknown), kRays * kRanges);
}

TEST(RoadColors, ASmallClusterOfSeedsIsNotTheRoad) {
  std::vector<Appearance> seeds(950, Appearance(100, 128, 128, 2));
  seeds.insert(seeds.end(), 50, Appearance(220, 128, 128, 2));

  const RoadColors colors(seeds);

  EXPECT_LT(colors.DistanceTo(Appearance(100, 128, 128, 2)), 1);
  EXPECT_GT(colors.DistanceTo(Appearance(220, 128, 128, 2)), 5);
}

TEST(RoadColors, BrightOrNeutralMayBePaintButDarkMayNot) {
  const RoadColors colors(std::vector<Appearance>(100, Appearance(100, 128, 128, 2)));

  EXPECT_TRUE(colors.MayBePaint(Appearance(220, 128, 128, 2)));
  EXPECT_TRUE(colors.MayBePaint(Appearance(180, 125, 190, 2))) << "yellow";
  EXPECT_FALSE(colors.MayBePaint(Appearance(60, 128, 128, 2)));
  EXPECT_FALSE(colors.MayBePaint(Appearance(110, 170, 150, 2))) << "red";
}

}  // namespace
}  // namespace parkade
