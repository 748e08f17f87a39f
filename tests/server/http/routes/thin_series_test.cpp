#include "server/http/routes/thin_series.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace parkade {
namespace {

TimeSeries Noise(size_t count) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  TimeSeries series;
  double time = 0;
  for (size_t i = 0; i < count; ++i) {
    series.times.push_back(time += 0.01 + 0.02 * std::abs(normal(random)));
    series.values.push_back(normal(random));
  }
  return series;
}

TEST(ThinSeries, AShortOneStaysAsItIs) {
  const TimeSeries series = Noise(100);

  const TimeSeries thin = ThinSeries(series, 100);

  EXPECT_EQ(thin.times, series.times);
  EXPECT_EQ(thin.values, series.values);
}

TEST(ThinRange, OfAShortRangeIsAsFineAsItWasMeasured) {
  const TimeSeries series = Noise(10000);
  const double begin = series.times[4000], end = series.times[4099];

  const ThinnedRange range = ThinRange(series, begin, end, 100);

  EXPECT_EQ(range.count, 100u);
  ASSERT_EQ(range.series.times.size(), 102u);
  EXPECT_EQ(range.series.times.front(), series.times[3999]);
  EXPECT_EQ(range.series.values.back(), series.values[4100]);
  EXPECT_EQ(range.series.values[50], series.values[4049]);
}

TEST(ThinRange, OutsideOfTheSeriesHasOnlyItsNeighbor) {
  const TimeSeries series = Noise(100);
  EXPECT_EQ(ThinRange(series, 1e6, 2e6, 10).series.times, std::vector{series.times.back()});
  EXPECT_EQ(ThinRange(series, -9, -8, 10).series.times, std::vector{series.times.front()});
  EXPECT_TRUE(ThinRange({}, 0, 1, 10).series.times.empty());
}

TEST(ThinSeries, KeepsTheExtremesOfEveryStretch) {
  constexpr int kPoints = 60;
  const TimeSeries series = Noise(10000);

  const TimeSeries thin = ThinSeries(series, kPoints);

  EXPECT_LE(thin.values.size(), static_cast<size_t>(kPoints));
  EXPECT_TRUE(std::is_sorted(thin.times.begin(), thin.times.end()));
  // The slow way: all samples of each stretch.
  const double begin = series.times.front(), width = (series.times.back() - begin) / (kPoints / 2);
  for (int bin = 0; bin < kPoints / 2; ++bin) {
    double least = 1e9, greatest = -1e9;
    for (size_t i = 0; i < series.times.size(); ++i) {
      const int own =
          std::min(kPoints / 2 - 1, static_cast<int>((series.times[i] - begin) / width));
      if (own != bin) continue;
      least = std::min(least, series.values[i]);
      greatest = std::max(greatest, series.values[i]);
    }
    EXPECT_EQ(std::count(thin.values.begin(), thin.values.end(), least), 1) << bin;
    EXPECT_EQ(std::count(thin.values.begin(), thin.values.end(), greatest), 1) << bin;
  }
}

TEST(ThinSeries, EveryPointIsASample) {
  const TimeSeries series = Noise(1000), thin = ThinSeries(series, 10);

  for (size_t i = 0; i < thin.times.size(); ++i) {
    const auto found = std::find(series.times.begin(), series.times.end(), thin.times[i]);
    ASSERT_NE(found, series.times.end());
    EXPECT_EQ(series.values[static_cast<size_t>(found - series.times.begin())], thin.values[i]);
  }
}

TEST(ThinSeries, WhatIsNotFiniteIsLeftOut) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const TimeSeries thin = ThinSeries({{0, 1, 2}, {nan, 5, nan}}, 2);

  EXPECT_EQ(thin.times, std::vector<double>{1});
  EXPECT_EQ(ThinSeries({{0, 1}, {nan, nan}}, 2).values.size(), 0u);
  EXPECT_EQ(ThinSeries({}, 2).values.size(), 0u);
}

}  // namespace
}  // namespace parkade
