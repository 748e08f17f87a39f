#include "mapping/observation/segment_ground.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "mapping/observation/road_colors.h"

namespace parkade {
namespace {

constexpr int kRays = 60, kRanges = 80;

/// A fan of rays with places every 10 cm, all visible: colors can be painted on it directly.
GroundGrid MakeFan() {
  GroundGrid grid{.num_rays = kRays,
                  .num_ranges = kRanges,
                  .angle_step = 0.02,
                  .ranges = {},
                  .pixel_lengths = std::vector<float>(kRanges, 0.1F),
                  .cells = {}};
  for (int range = 0; range < kRanges; ++range)
    grid.ranges.push_back(0.1F * static_cast<float>(range + 5));
  for (int ray = 0; ray < kRays; ++ray)
    for (int range = 0; range < kRanges; ++range) {
      const float angle = 0.02F * static_cast<float>(ray),
                  radius = grid.ranges[static_cast<size_t>(range)];
      grid.cells.push_back({.pixel = {static_cast<float>(ray), static_cast<float>(range)},
                            .point_in_ground = {radius * std::cos(angle), radius * std::sin(angle)},
                            .weight = 1,
                            .is_visible = true});
    }
  return grid;
}

class SegmentingAFan : public testing::Test {
 protected:
  SegmentingAFan() : colors_(kRays, kRanges, CV_8UC3, cv::Scalar(90, 92, 91)) {
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

TEST_F(SegmentingAFan, ARoadOfOneColorIsGroundThroughout) {
  const std::vector<GroundLabel> labels = SegmentGround(grid_, colors_, seeds_);

  EXPECT_GT(std::count(labels.begin(), labels.end(), GroundLabel::kGround),
            kRays * kRanges * 98 / 100);
}

TEST_F(SegmentingAFan, ARedCarIsNotGround) {
  Paint(25, 40, 12, 40, {30, 30, 170});

  const std::vector<GroundLabel> labels = SegmentGround(grid_, colors_, seeds_);

  for (int ray = 27; ray < 35; ++ray)
    for (int range = 42; range < 78; ++range)
      EXPECT_EQ(At(labels, ray, range), GroundLabel::kNotGround);
  EXPECT_EQ(At(labels, 10, 60), GroundLabel::kGround);
}

TEST_F(SegmentingAFan, AThinWhiteLineWithRoadOnBothSidesIsPaint) {
  Paint(0, 40, kRays - 10, 2, {225, 225, 225});

  const std::vector<GroundLabel> labels = SegmentGround(grid_, colors_, seeds_);

  EXPECT_EQ(At(labels, 30, 40), GroundLabel::kGround);
  EXPECT_EQ(At(labels, 30, 70), GroundLabel::kGround);
}

TEST_F(SegmentingAFan, WhatAWhiteKerbEnclosesIsNotReached) {
  Paint(0, 40, kRays, 2, {225, 225, 225});

  const std::vector<GroundLabel> labels = SegmentGround(grid_, colors_, seeds_);

  EXPECT_EQ(At(labels, 30, 20), GroundLabel::kGround);
  EXPECT_EQ(At(labels, 30, 70), GroundLabel::kNotGround);
}

TEST_F(SegmentingAFan, AThinBlackGapIsNotPaint) {
  Paint(0, 40, kRays, 3, {10, 10, 10});

  const std::vector<GroundLabel> labels = SegmentGround(grid_, colors_, seeds_);

  EXPECT_EQ(At(labels, 30, 41), GroundLabel::kNotGround);
  EXPECT_EQ(At(labels, 30, 70), GroundLabel::kNotGround) << "nothing leads there";
}

TEST_F(SegmentingAFan, RoadInShadeIsGroundWhenTheSeedsShowBoth) {
  Paint(0, 0, kRays, kRanges, {90, 92, 91});
  Paint(30, 0, 30, kRanges, {50, 48, 46});

  const std::vector<GroundLabel> labels = SegmentGround(grid_, colors_, seeds_);

  EXPECT_EQ(At(labels, 10, 60), GroundLabel::kGround);
  EXPECT_EQ(At(labels, 50, 60), GroundLabel::kGround);
}

TEST_F(SegmentingAFan, WithoutSeedsNothingIsCalledGround) {
  const std::vector<GroundLabel> labels =
      SegmentGround(grid_, colors_, std::vector<std::uint8_t>(grid_.cells.size()));

  EXPECT_EQ(std::count(labels.begin(), labels.end(), GroundLabel::kUnknown), kRays * kRanges);
}

TEST_F(SegmentingAFan, AMaskIsLookedUpAtEachPlace) {
  cv::Mat mask(kRanges, kRays, CV_8UC1, cv::Scalar(0));
  mask(cv::Rect(0, 0, kRays, 30)).setTo(255);

  const std::vector<GroundLabel> labels = LabelsFromMask(grid_, mask);

  EXPECT_EQ(At(labels, 10, 29), GroundLabel::kGround);
  EXPECT_EQ(At(labels, 10, 30), GroundLabel::kNotGround);
}

/// What a network that has the same log-odds everywhere says, sure from 2 on.
GroundLabels LabelsFrom(const GroundGrid& grid, float log_odds, double doubt_per_meter,
                        double doubt_from = 0) {
  const FreespaceBelief belief{cv::Mat(4, 4, CV_32FC1, cv::Scalar(log_odds)), {kRays, kRanges}};
  SegmentGroundOptions options;
  options.sure_log_odds = 2;
  options.doubt_per_meter = doubt_per_meter;
  options.doubt_from = doubt_from;
  return LabelsFromBelief(grid, std::vector<Eigen::Vector2f>(grid.cells.size(), {5, 5}), belief,
                          options);
}

TEST_F(SegmentingAFan, FarGroundMustBeTheSurer) {
  const GroundLabels found = LabelsFrom(grid_, 1, 0.25, 2);

  constexpr int kTwoMeters = 15, kSixMeters = 55;
  EXPECT_EQ(At(found.labels, 10, kSixMeters - 1), GroundLabel::kGround);
  EXPECT_EQ(At(found.labels, 10, kSixMeters + 1), GroundLabel::kDoubtful);
  EXPECT_NEAR(found.confidence[static_cast<size_t>(grid_.IndexOf(10, kTwoMeters))], 0.5, 1e-6);
  EXPECT_NEAR(found.confidence[static_cast<size_t>(grid_.IndexOf(10, kSixMeters - 4))], 0.05, 1e-6);
}

TEST_F(SegmentingAFan, WhatIsNotGroundIsTheLessSoNearTheCar) {
  const GroundLabels found = LabelsFrom(grid_, -1, 0.25, 6);

  constexpr int kOneMeter = 5, kSixMeters = 55;
  EXPECT_EQ(At(found.labels, 10, kOneMeter), GroundLabel::kDoubtful);
  EXPECT_EQ(At(found.labels, 10, kSixMeters), GroundLabel::kNotGround);
  EXPECT_NEAR(found.confidence[static_cast<size_t>(grid_.IndexOf(10, kSixMeters))], 0.5, 1e-6);
}

TEST_F(SegmentingAFan, WithoutDoubtANetworkIsTakenAtItsWord) {
  const GroundLabels found = LabelsFrom(grid_, 1, 0);

  EXPECT_EQ(At(found.labels, 10, kRanges - 1), GroundLabel::kGround);
  EXPECT_NEAR(found.confidence.back(), 0.5, 1e-6);
}

TEST_F(SegmentingAFan, ANetworkThatKnowsNothingSaysNothing) {
  for (const GroundLabel label : LabelsFrom(grid_, 0, 0.25, 2).labels)
    EXPECT_EQ(label, GroundLabel::kDoubtful);
}

class HidingBehindObstacles : public testing::Test {
 protected:
  /// g ground, n not ground, u unknown: one letter per range of the only ray.
  static std::string Hide(const std::string& before, bool is_trusted, double obstacle_depth = 0.5,
                          double beyond_depth = 0) {
    GroundGrid grid{.num_rays = 1,
                    .num_ranges = static_cast<int>(before.size()),
                    .angle_step = 0.02,
                    .ranges = {},
                    .pixel_lengths = std::vector<float>(before.size(), 0.3F),
                    .cells = {}};
    std::vector<GroundLabel> labels;
    for (size_t i = 0; i < before.size(); ++i) {
      grid.ranges.push_back(0.25F * static_cast<float>(i + 1));
      labels.push_back(before[i] == 'g'   ? GroundLabel::kGround
                       : before[i] == 'n' ? GroundLabel::kNotGround
                                          : GroundLabel::kUnknown);
    }
    grid.cells.resize(before.size());
    SegmentGroundOptions options;
    options.obstacle_depth = obstacle_depth;
    options.foot_depth = 0.15;
    options.beyond_depth = beyond_depth;
    HideBehindObstacles(grid, options, is_trusted, labels);
    std::string after;
    for (const GroundLabel label : labels)
      after += label == GroundLabel::kGround      ? 'g'
               : label == GroundLabel::kNotGround ? 'n'
               : label == GroundLabel::kHidden    ? 'h'
               : label == GroundLabel::kBeyond    ? 'b'
                                                  : 'u';
    return after;
  }
};

TEST_F(HidingBehindObstacles, OnlyTheFootOfAnObstacleIsKnown) {
  EXPECT_EQ(Hide("ggnnnnnn", true), "ggnnuuuu");
}
TEST_F(HidingBehindObstacles, ShortlyBehindTheFootIsAHint) {
  EXPECT_EQ(Hide("ggnnnnnn", true, 1), "ggnnhhuu");
}
TEST_F(HidingBehindObstacles, FurtherBehindColorsAreKept) {
  EXPECT_EQ(Hide("ggnnnnnnn", true, 1, 1.5), "ggnnhhbbu");
  EXPECT_EQ(Hide("ggnnnnnnn", false, 0.5, 1), "ggnnbbuuu");
  EXPECT_EQ(Hide("nngnn", true, 0.5, 1), "uugnn") << "but nothing of the own car";
}
TEST_F(HidingBehindObstacles, AGuessEndsAtTheFirstObstacle) {
  EXPECT_EQ(Hide("ggnnnngg", false), "ggnnuuuu");
}
TEST_F(HidingBehindObstacles, AMaskMaySeeGroundAgainBehind) {
  EXPECT_EQ(Hide("ggnnnnggnnn", true), "ggnnuuggnnu");
}
TEST_F(HidingBehindObstacles, WhatComesBeforeTheFirstGroundIsTheOwnCar) {
  EXPECT_EQ(Hide("nnggg", false), "uuggg");
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
