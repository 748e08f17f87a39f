#include "mapping/ground/nearest_views.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace parkade {
namespace {

TEST(ChooseNearest, TakesTheNearestAndLetsThemCountForAllTheyShow) {
  // View 0 shows both targets, view 1 the first and view 2 the second from farther away.
  const std::vector<TargetView> views = {{3, 1, 0}, {1, 0, 0}, {2, 0, 1}, {2.5F, 2, 1}};
  EXPECT_EQ(ChooseNearest(views, 3, {1, 1}), (std::vector{true, false, false}));
  EXPECT_EQ(ChooseNearest(views, 3, {2, 1}), (std::vector{true, true, false}));
  EXPECT_EQ(ChooseNearest(views, 3, {1, 2}), (std::vector{true, false, true}));
}

TEST(ChooseNearest, GivesEveryTargetWhatItWantsOrAllThereIs) {
  constexpr std::uint32_t kViews = 300, kTargets = 40;
  constexpr int kWanted = 7;
  std::mt19937 random(1);
  std::uniform_int_distribution<int> place(0, 100);  // distances tie
  std::vector<float> of_views(kViews), of_targets(kTargets);
  for (float& x : of_views) x = static_cast<float>(place(random));
  for (float& x : of_targets) x = static_cast<float>(place(random));
  std::vector<TargetView> views;
  std::vector<int> num_showing(kTargets), num_chosen(kTargets);
  for (std::uint32_t view = 0; view < kViews; ++view)
    for (std::uint32_t target = 0; target < kTargets; ++target)
      if (const float distance = std::abs(of_views[view] - of_targets[target]); distance < 4) {
        views.push_back({distance, view, target});
        ++num_showing[target];
      }

  const std::vector<bool> is_chosen =
      ChooseNearest(views, kViews, std::vector<int>(kTargets, kWanted));

  for (const TargetView& view : views) num_chosen[view.target] += is_chosen[view.view];
  for (std::uint32_t target = 0; target < kTargets; ++target)
    EXPECT_GE(num_chosen[target], std::min(kWanted, num_showing[target])) << target;
  EXPECT_LT(std::count(is_chosen.begin(), is_chosen.end(), true), kViews * 2 / 3);
  std::shuffle(views.begin(), views.end(), random);
  EXPECT_EQ(ChooseNearest(views, kViews, std::vector<int>(kTargets, kWanted)), is_chosen)
      << "whatever their order";
}

TEST(NearestOfChosen, GivesEachTargetNoMoreThanItWants) {
  // Views 0 to 2 show the only target, view 1 was not chosen.
  const std::vector<TargetView> views = {{3, 0, 0}, {1, 1, 0}, {2, 2, 0}};
  const std::vector<bool> is_chosen = {true, false, true};
  EXPECT_EQ(NearestOfChosen(views, is_chosen, {1}), (std::vector{false, false, true}));
  EXPECT_EQ(NearestOfChosen(views, is_chosen, {2}), (std::vector{true, false, true}));
  EXPECT_EQ(NearestOfChosen(views, is_chosen, {0}), (std::vector{false, false, false}));
}

TEST(ChooseNearest, OfNothingTakesNothing) {
  EXPECT_EQ(ChooseNearest({}, 2, {1}), (std::vector{false, false}));
}

}  // namespace
}  // namespace parkade
