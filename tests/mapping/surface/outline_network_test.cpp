#include "mapping/surface/outline_network.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>

#include "mapping/evaluation/compare_surfaces.h"
#include "mapping/surface/outline_features.h"

namespace parkade {
namespace {

using PaintedCell = SurfacePainter::PaintedCell;

constexpr double kMaxStep = 0.1;  // [m]

double LogOdds(const PaintedCell& cell) {
  const auto belief = static_cast<double>(cell.cell.free_belief);
  return std::log(belief / (1 - belief));
}

/// Ground with patches of all colors and beliefs, some cells unseen, a lane driven. The latest
/// drive is surer of it than all are.
std::vector<PaintedCell> MakeGround(const Eigen::Vector2i& corner, const Eigen::Vector2i& size,
                                    unsigned seed) {
  std::vector<PaintedCell> cells;
  for (int y = 0; y < size.y(); ++y)
    for (int x = 0; x < size.x(); ++x) {
      // Of the place alone, so that grounds of one seed are parts of one.
      std::mt19937 of_block(seed + 1000003U * static_cast<unsigned>(x / 8) +
                            7919U * static_cast<unsigned>(y / 8));
      std::mt19937 of_cell(seed + 7919U * static_cast<unsigned>(x) +
                           1000003U * static_cast<unsigned>(y));
      PaintedCell& painted = cells.emplace_back();
      painted.cell = {.x = corner.x() + x, .y = corner.y() + y};
      painted.cell.free_belief = 0.02F + 0.96F * static_cast<float>(of_block() % 100) / 100;
      painted.shown_log_odds = 1.5F * static_cast<float>(LogOdds(painted));
      for (std::uint8_t& value : painted.cell.color)
        value = static_cast<std::uint8_t>(of_block() % 256);
      painted.observations = {.free = static_cast<std::uint8_t>(of_cell() % 256),
                              .occupied = static_cast<std::uint8_t>(of_block() % 256),
                              .nearness = static_cast<std::uint8_t>(of_block() % 192),
                              .disagreement = static_cast<std::uint8_t>(of_cell() % 100),
                              .free_views = static_cast<std::uint8_t>(of_block() % 33),
                              .occupied_views = static_cast<std::uint8_t>(of_block() % 33)};
      painted.is_seen = of_cell() % 50 != 0;
      painted.is_driven = y / 20 == 3;
      painted.raised = 0.001F * static_cast<float>(of_block() % 150) - 0.05F;
      painted.measured = painted.raised;
      painted.certainty = static_cast<float>(of_block() % 100) / 100;
    }
  return cells;
}

TEST(OutlineFeatures, AreMeansOfSeenCells) {
  const std::vector<PaintedCell> cells = MakeGround({-5, 4}, {60, 40}, 1);
  const std::vector<DeckRaster> decks =
      CutIntoDecks(cells, LinkPaintedCells(cells, kMaxStep), kOutlineFactor, 1);
  ASSERT_EQ(decks.size(), 1);
  const cv::Rect window(-3, 2, 20, 30);
  const cv::Mat features = OutlineFeatures(cells, decks[0], window);
  ASSERT_EQ(features.size[1], kOutlineFeatures);
  cv::Mat blue(window.size(), CV_64F, cv::Scalar(0)), belief = blue.clone(), seen = blue.clone(),
                                                      raised = blue.clone();
  for (const PaintedCell& cell : cells) {
    const cv::Point at((cell.cell.x - decks[0].origin.x()) / 2 - window.x,
                       (cell.cell.y - decks[0].origin.y()) / 2 - window.y);
    if (!cell.is_seen || !cv::Rect({}, window.size()).contains(at)) continue;
    seen.at<double>(at) += 0.25;
    const double log_odds =
        cell.is_driven ? LogOdds(cell) : static_cast<double>(cell.shown_log_odds);
    belief.at<double>(at) += 0.25 * log_odds / 8;
    raised.at<double>(at) += 0.25 * static_cast<double>(cell.raised) / 0.1;
    blue.at<double>(at) += 0.25 * (cell.cell.color[2] / 255.0 - 0.5);
  }
  for (int row = 0; row < window.height; ++row)
    for (int column = 0; column < window.width; ++column) {
      EXPECT_NEAR(features.ptr<float>(0, 0, row)[column], seen.at<double>(row, column), 1e-6);
      EXPECT_NEAR(features.ptr<float>(0, 1, row)[column], belief.at<double>(row, column), 1e-5);
      EXPECT_NEAR(features.ptr<float>(0, 11, row)[column], blue.at<double>(row, column), 1e-5);
      EXPECT_NEAR(features.ptr<float>(0, 12, row)[column], raised.at<double>(row, column), 1e-5);
    }
}

TEST(OutlineNetwork, CorrectsWhatWasSeenAndNotDrivenOnWithinBounds) {
  const std::vector<PaintedCell> before = MakeGround({-100, 30}, {150, 120}, 2);
  std::vector<PaintedCell> after = before;
  OutlineNetwork().Refine(LinkPaintedCells(after, kMaxStep), after);
  int num_changed = 0;
  for (size_t i = 0; i < before.size(); ++i) {
    if (!before[i].is_seen || before[i].is_driven) {
      EXPECT_EQ(after[i].cell.free_belief, before[i].cell.free_belief);
      continue;
    }
    const double correction = LogOdds(after[i]) - LogOdds(before[i]);
    EXPECT_LE(std::abs(correction),
              static_cast<double>(OutlineNetwork::kMaxCorrection - OutlineNetwork::kDoubt) + 0.02);
    num_changed += std::abs(correction) > 0.1;
  }
  EXPECT_GT(num_changed, 1000);
}

TEST(OutlineNetwork, MakesNothingSurerThanObservationsAre) {
  const std::vector<PaintedCell> before = MakeGround({-100, 30}, {150, 120}, 2);
  std::vector<PaintedCell> after = before;
  OutlineNetwork().Refine(LinkPaintedCells(after, kMaxStep), after);
  const double sure = std::log(CompareOptions{}.sure_belief / (1 - CompareOptions{}.sure_belief));
  int num_turned = 0;
  for (size_t i = 0; i < before.size(); ++i) {
    const double was = LogOdds(before[i]), is = LogOdds(after[i]);
    if (std::abs(is) >= sure) {
      EXPECT_LE(std::abs(is), std::abs(was) + 1e-4);
      EXPECT_GT(is * was, 0);
    }
    num_turned += is * was < 0;
  }
  EXPECT_GT(num_turned, 300);
}

TEST(OutlineNetwork, ACellDependsOnWhatIsNear) {
  const Eigen::Vector2i corner(400, -130), size(300, 200);  // across a border of blocks
  std::vector<PaintedCell> whole = MakeGround(corner, size, 3), changed = whole;
  const int from = 150;
  for (PaintedCell& cell : changed)
    if (cell.cell.x - corner.x() >= from)
      cell.cell.free_belief = 0.3F, cell.cell.color = {200, 10, 10};
  const OutlineNetwork network;
  network.Refine(LinkPaintedCells(whole, kMaxStep), whole);
  network.Refine(LinkPaintedCells(changed, kMaxStep), changed);
  int num_far = 0, num_near_changed = 0;
  for (size_t i = 0; i < whole.size(); ++i) {
    const int x = whole[i].cell.x - corner.x();
    const double difference = std::abs(LogOdds(whole[i]) - LogOdds(changed[i]));
    if (x < from - OutlineNetwork::kReach * kOutlineFactor) {
      EXPECT_LT(difference, 0.02);  // a step of corrections
      num_far += difference > 0;
    } else if (x < from) {
      num_near_changed += difference > 0.05;
    }
  }
  EXPECT_LT(num_far, 20);
  EXPECT_GT(num_near_changed, 100);
}

TEST(OutlineNetwork, APlaceIsTheSameElsewhere) {
  std::vector<PaintedCell> here = MakeGround({-30, 40}, {150, 120}, 4),
                           there = MakeGround({482, -984}, {150, 120}, 4);
  const OutlineNetwork network;
  network.Refine(LinkPaintedCells(here, kMaxStep), here);
  network.Refine(LinkPaintedCells(there, kMaxStep), there);
  for (size_t i = 0; i < here.size(); ++i)
    EXPECT_EQ(here[i].cell.free_belief, there[i].cell.free_belief);
}

TEST(OutlineNetwork, LeavesNothingAndLittleAsItIs) {
  std::vector<PaintedCell> none, little = MakeGround({0, 0}, {20, 20}, 5);
  const OutlineNetwork network;
  network.Refine(LinkPaintedCells(none, kMaxStep), none);
  EXPECT_TRUE(none.empty());
  const std::vector<PaintedCell> before = little;
  network.Refine(LinkPaintedCells(little, kMaxStep), little);
  for (size_t i = 0; i < little.size(); ++i)
    EXPECT_EQ(little[i].cell.free_belief, before[i].cell.free_belief);
}

}  // namespace
}  // namespace parkade
