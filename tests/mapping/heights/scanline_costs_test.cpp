#include "mapping/heights/scanline_costs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace parkade {
namespace {

std::size_t BestOf(const std::vector<float>& sums, std::size_t window, std::size_t num_heights) {
  const auto row = sums.begin() + static_cast<std::ptrdiff_t>(window * num_heights);
  return static_cast<std::size_t>(
      std::min_element(row, row + static_cast<std::ptrdiff_t>(num_heights)) - row);
}

float PenaltyOf(std::size_t a, std::size_t b, const StepPenalties& penalties) {
  const auto step = static_cast<float>(a) - static_cast<float>(b);
  return std::min(penalties.most, penalties.per_step * std::abs(step));
}

/// All ways to give four windows in a row one of five heights.
TEST(SumAlongScanlines, TellsOfARowWhatTryingAllHeightsTells) {
  constexpr std::size_t kWindows = 4, kHeights = 5;
  const std::vector<GridPlace> places{{3, 1}, {4, 1}, {5, 1}, {6, 1}};
  const StepPenalties penalties{0.7F, 4};
  std::mt19937 random(3);
  std::uniform_real_distribution<float> cost(-6, 0);
  std::vector<float> costs(kWindows * kHeights);
  std::generate(costs.begin(), costs.end(), [&] { return cost(random); });

  const std::vector<float> sums = SumAlongScanlines(places, costs, kHeights, penalties);

  std::vector<float> least(costs.size(), 1e9F);
  for (std::size_t all = 0; all < 625; ++all) {
    const std::size_t of[] = {all % 5, all / 5 % 5, all / 25 % 5, all / 125};
    float sum = 0;
    for (std::size_t i = 0; i < kWindows; ++i) {
      sum += costs[i * kHeights + of[i]];
      if (i > 0) sum += PenaltyOf(of[i - 1], of[i], penalties);
    }
    for (std::size_t i = 0; i < kWindows; ++i)
      least[i * kHeights + of[i]] = std::min(least[i * kHeights + of[i]], sum);
  }
  const float best = *std::min_element(least.begin(), least.end());
  for (std::size_t i = 0; i < costs.size(); ++i) EXPECT_NEAR(sums[i], least[i] - best, 1e-4);
}

/// A square of windows; `says(x, y)` is the height that a window is sure of, or none.
template <typename Says>
std::vector<float> SumsOfSquare(int side, std::size_t num_heights, const Says& says) {
  std::vector<GridPlace> places;
  std::vector<float> costs;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      places.push_back({x, y});
      const int sure_of = says(x, y);
      for (std::size_t h = 0; h < num_heights; ++h)
        costs.push_back(static_cast<int>(h) == sure_of ? -8.0F : 0.0F);
    }
  return SumAlongScanlines(places, costs, num_heights, {});
}

TEST(SumAlongScanlines, AStepSurvives) {
  const auto sums = SumsOfSquare(12, 20, [](int x, int) { return x < 6 ? 3 : 14; });
  for (int y = 0; y < 12; ++y)
    for (int x = 0; x < 12; ++x)
      EXPECT_EQ(BestOf(sums, static_cast<std::size_t>(12 * y + x), 20), x < 6 ? 3u : 14u);
}

TEST(SumAlongScanlines, AWindowThatIsWrongOrSaysNothingTakesTheHeightAroundIt) {
  const auto sums = SumsOfSquare(9, 20, [](int x, int y) {
    if (x == 4 && y == 4) return 17;
    return x == 2 && y == 2 ? -1 : 5;
  });
  EXPECT_EQ(BestOf(sums, 9 * 4 + 4, 20), 5u);
  EXPECT_EQ(BestOf(sums, 9 * 2 + 2, 20), 5u);
}

TEST(SumAlongScanlines, DecksAreNoNeighbors) {
  const std::vector<GridPlace> places{{0, 0, 0}, {1, 0, 3}};
  const auto sums = SumAlongScanlines(places, std::vector<float>{-9, 0, 0, 0, 0, 0}, 3, {});
  EXPECT_EQ(sums[3], 0);
  EXPECT_EQ(sums[5], 0);
}

TEST(SumAlongChains, AreTheLeastThatHeightsOfTheOthersMake) {
  constexpr std::size_t kHeights = 3;
  const std::vector<int> before = {-1, 0, -1, 1};  // 0, 1, 3 follow each other; 2 is alone
  const std::vector<float> costs = {0, 2, 5, 3, 0, 4, 1, 2, 3, 2, 2, 0};
  const StepPenalties penalties{0.7F, 1};
  std::vector<float> least(costs.size(), 1e9F);
  for (std::size_t a = 0; a < kHeights; ++a)
    for (std::size_t b = 0; b < kHeights; ++b)
      for (std::size_t c = 0; c < kHeights; ++c) {
        const float sum = costs[a] + costs[3 + b] + costs[9 + c] + PenaltyOf(a, b, penalties) +
                          PenaltyOf(b, c, penalties);
        for (const std::size_t at : {a, 3 + b, 9 + c}) least[at] = std::min(least[at], sum);
      }
  for (std::size_t i = 6; i < 9; ++i) least[i] = costs[i];
  std::vector<float> sums = SumAlongChains(before, costs, kHeights, penalties);
  SubtractLeast(sums, kHeights), SubtractLeast(least, kHeights);
  for (std::size_t i = 0; i < costs.size(); ++i) EXPECT_NEAR(sums[i], least[i], 1e-5F) << i;
}

}  // namespace
}  // namespace parkade
