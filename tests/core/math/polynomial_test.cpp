#include "core/math/polynomial.h"

#include <gtest/gtest.h>

namespace parkade {
namespace {

TEST(FindSignChanges, GivesTheRootsInsideTheIntervalInOrder) {
  // (x - 1)(x - 2)(x + 3)(x - 7) = x^4 - 7x^3 - 7x^2 + 55x - 42
  const std::vector<double> roots = FindSignChanges({-42, 55, -7, -7, 1}, 0, 5);

  ASSERT_EQ(roots.size(), 2U);
  EXPECT_NEAR(roots[0], 1, 1e-14);
  EXPECT_NEAR(roots[1], 2, 1e-14);
}

TEST(FindSignChanges, ATouchedAxisIsNotARoot) {
  EXPECT_TRUE(FindSignChanges({1.0001, -2, 1}, -10, 10).empty());
  EXPECT_TRUE(FindSignChanges({5}, -1, 1).empty());
  EXPECT_TRUE(FindSignChanges({1, 0, 0, 0}, 0, 10).empty());
}

}  // namespace
}  // namespace parkade
