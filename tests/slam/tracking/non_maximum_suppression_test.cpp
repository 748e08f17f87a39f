#include "slam/tracking/non_maximum_suppression.h"

#include <gtest/gtest.h>

namespace parkade {
namespace {

TEST(SuppressNonMaxima, OfThoseThatMeetTheFirstGoesOn) {
  const std::vector<Eigen::Vector2d> pixels = {{0, 0}, {2, 0}, {4, 0}, {4.5, 3}, {100, 0}};

  EXPECT_EQ(SuppressNonMaxima(pixels, 3.5), (std::vector<size_t>{0, 2, 4}));
  EXPECT_EQ(SuppressNonMaxima(pixels, 0).size(), pixels.size());
  EXPECT_TRUE(SuppressNonMaxima({}, 1).empty());
}

}  // namespace
}  // namespace parkade
