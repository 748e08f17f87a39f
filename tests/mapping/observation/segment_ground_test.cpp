#include "mapping/observation/segment_ground.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "tests/mapping/worlds/fan_grid.h"

namespace parkade {
namespace {

class SegmentingAFan : public testing::Test {
 protected:
  GroundLabel At(const std::vector<GroundLabel>& labels, int ray, int range) const {
    return labels[static_cast<size_t>(grid_.IndexOf(ray, range))];
  }

  GroundGrid grid_ = MakeFan();
};

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
    GroundLabels found;
    found.is_trusted = is_trusted;
    for (size_t i = 0; i < before.size(); ++i) {
      grid.ranges.push_back(0.25F * static_cast<float>(i + 1));
      found.labels.push_back(before[i] == 'g'   ? GroundLabel::kGround
                             : before[i] == 'u' ? GroundLabel::kUnknown
                                                : GroundLabel::kNotGround);
    }
    grid.cells.resize(before.size());
    SegmentGroundOptions options;
    options.obstacle_depth = obstacle_depth;
    options.foot_depth = 0.15;
    options.beyond_depth = beyond_depth;
    HideBehindObstacles(grid, options, found);
    std::string after;
    for (const GroundLabel label : found.labels)
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

}  // namespace
}  // namespace parkade
