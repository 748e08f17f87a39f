#include "core/math/statistics.h"

#include <gtest/gtest.h>

namespace parkade {
namespace {

TEST(Statistics, TheMedianIsTheUpperOneOfAnEvenNumber) {
  EXPECT_EQ(Median(std::vector<double>{5, 1, 3}), 3);
  EXPECT_EQ(Median(std::vector<double>{4, 1, 3, 2}), 3);
  EXPECT_EQ(Median(std::vector<float>{7}), 7.0F);
}

TEST(Statistics, NothingHasTheMedianZero) {
  EXPECT_EQ(Median(std::vector<double>{}), 0);
  EXPECT_EQ(Quantile({}, 0.9), 0);
  EXPECT_EQ(MadSigma({}, 3), 0);
}

TEST(Statistics, EachRankHasItsValue) {
  for (std::size_t rank = 0; rank < 5; ++rank) {
    std::vector<double> values{40, 10, 0, 30, 20};
    EXPECT_EQ(NthSmallest(values, rank), 10.0 * static_cast<double>(rank));
  }
}

TEST(Statistics, AQuantileIsTheValueOfTheNearestRank) {
  const std::vector<double> values{4, 0, 3, 1, 2};
  EXPECT_EQ(Quantile(values, 0), 0);
  EXPECT_EQ(Quantile(values, 0.5), 2);
  EXPECT_EQ(Quantile(values, 0.6), 2) << "rank 2.4";
  EXPECT_EQ(Quantile(values, 0.9), 4) << "rank 3.6";
  EXPECT_EQ(Quantile(values, 1), 4);
}

TEST(Statistics, OutliersDoNotWidenTheRobustSigma) {
  const std::vector<double> values{9, 10, 11, 12, 8, 1000};
  EXPECT_DOUBLE_EQ(MadSigma(values, 10), 1.4826 * 2);
  EXPECT_DOUBLE_EQ(MadSigma({-1, 1, -1}, 0), 1.4826);
}

}  // namespace
}  // namespace parkade
