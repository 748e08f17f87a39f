#include "mapping/surface/ray_direction.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace parkade {
namespace {

int SlowDirectionOf(const Eigen::Vector2d& ray) {
  const double turn = (std::atan2(ray.y(), ray.x()) + std::numbers::pi) / (2 * std::numbers::pi);
  return static_cast<int>(turn * kNumRayDirections) % kNumRayDirections;
}

TEST(RayDirection, IsThatOfTheArcTangent) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> coordinate(-9, 9);
  for (int i = 0; i < 200000; ++i) {
    const Eigen::Vector2d ray(coordinate(random), coordinate(random));
    ASSERT_EQ(DirectionOf(ray), SlowDirectionOf(ray)) << ray.transpose();
  }
}

TEST(RayDirection, IsThatOfTheArcTangentWherePartsOfATurnMeet) {
  for (int i = 0; i <= 8 * kNumRayDirections; ++i)
    for (const double off :
         {0.0, 1e-16, -1e-16, 1e-12, -1e-12, 1e-6, -1e-6, 1e-5, -1e-5, 3e-5, -3e-5}) {
      const double angle =
          i * 2 * std::numbers::pi / (8 * kNumRayDirections) - std::numbers::pi + off;
      const Eigen::Vector2d ray(3 * std::cos(angle), 3 * std::sin(angle));
      ASSERT_EQ(DirectionOf(ray), SlowDirectionOf(ray)) << i << " " << off;
    }
}

TEST(RayDirection, RaysAlongAxesAndNoneHaveOne) {
  for (const double x : {-1.0, -0.0, 0.0, 1.0, 1e300, 1e-300})
    for (const double y : {-1.0, -0.0, 0.0, 1.0, 1e300, 1e-300})
      EXPECT_EQ(DirectionOf({x, y}), SlowDirectionOf({x, y})) << x << " " << y;
}

}  // namespace
}  // namespace parkade
