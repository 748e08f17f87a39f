#include "slam/tracking/parallax_field.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

namespace parkade {
namespace {

TEST(ParallaxOf, IsStepPerRange) {
  const Eigen::Vector3d step(0.1, 0, -1.2), point(2, 1, 8);
  const Eigen::Vector3d direction = step.normalized();

  EXPECT_NEAR(ParallaxOf(point.normalized(), (point + step).normalized(), direction),
              step.norm() / point.norm(), 1e-9);
  EXPECT_EQ(ParallaxOf(point.normalized(), point.normalized(), direction), 0);
  EXPECT_EQ(ParallaxOf(point.normalized(), (point - step).normalized(), direction), 0)
      << "against the motion";
  EXPECT_EQ(ParallaxOf(direction, direction, direction), 0) << "at the epipole nothing is known";
}

TEST(ParallaxField, ContinuesThePlaneOfTheRoad) {
  const double height = 1.6, step = 1.2;
  const auto on_road = [&](double forward, double right) {
    return Eigen::Vector3d(right, height, forward);
  };
  std::mt19937 random(3);
  std::uniform_real_distribution<double> forward(8, 20), right(-3, 3);
  ParallaxField field;
  for (int i = 0; i < 40; ++i) {
    const Eigen::Vector3d point = on_road(forward(random), right(random));
    field.Add(point.normalized(), step / point.norm());
  }

  const Eigen::Vector3d near = on_road(6, 0.5);  // nearer than every sample
  const auto parallax = field.At(near.normalized());

  ASSERT_TRUE(parallax);
  EXPECT_NEAR(*parallax, step / near.norm(), 0.15 * step / near.norm());
}

TEST(ParallaxField, StaysBetweenNothingAndTwiceItsNeighbors) {
  ParallaxField field;
  EXPECT_FALSE(field.At({0, 0, 1}));
  for (int i = 0; i < 10; ++i) field.Add(Eigen::Vector3d(0.02 * i, 0, 1).normalized(), 0.01 * i);

  EXPECT_EQ(field.At(Eigen::Vector3d(-1, 0, 0.2).normalized()), 0);
  EXPECT_LE(field.At(Eigen::Vector3d(1, 0, 0.1).normalized()).value(), 0.18);
}

}  // namespace
}  // namespace parkade
