#include "core/math/dual.h"

#include <gtest/gtest.h>

namespace parkade {
namespace {

// Every operation once, in one expression of two variables.
template <typename T>
T Expression(const T& x, const T& y) {
  using std::atan2;
  using std::sqrt;
  return sqrt(x * x + 2.0 * y) / (3.0 - y) + atan2(y, x) * (x - 1.0) - (-y + 0.5) / 4.0 +
         1.0 / (x + y);
}

TEST(Dual, DerivativesMatchFiniteDifferences) {
  for (const double x : {-1.3, 0.4, 2.0}) {
    for (const double y : {1.1, 2.5}) {
      const auto dual = Expression(Dual<2>::Variable(x, 0), Dual<2>::Variable(y, 1));

      constexpr double kStep = 1e-6;
      const double by_x = (Expression(x + kStep, y) - Expression(x - kStep, y)) / (2 * kStep);
      const double by_y = (Expression(x, y + kStep) - Expression(x, y - kStep)) / (2 * kStep);
      EXPECT_NEAR(dual.a, Expression(x, y), 1e-14);
      EXPECT_NEAR(dual.v[0], by_x, 1e-7 * (1 + std::abs(by_x)));
      EXPECT_NEAR(dual.v[1], by_y, 1e-7 * (1 + std::abs(by_y)));
    }
  }
}

}  // namespace
}  // namespace parkade
