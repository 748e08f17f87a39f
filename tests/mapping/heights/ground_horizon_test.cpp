#include "mapping/heights/ground_horizon.h"

#include <gtest/gtest.h>

#include <random>

#include "mapping/heights/intersect_ray.h"

namespace parkade {
namespace {

/// Humps of half a meter on ground that falls by 3 %; half of the ground is known to `sigma` [m],
/// the rest not well.
HeightField Humps(double sigma) {
  std::vector<HeightObservation> heights;
  for (double x = -12; x < 12; x += 0.2)
    for (double y = -12; y < 12; y += 0.2) {
      const double known = std::fmod(std::abs(x) + 2 * std::abs(y), 7.0) < 3.5 ? sigma : 0.3;
      heights.push_back(
          {{x, y, 0.03 * x + 0.5 * std::sin(0.9 * x) * std::cos(0.7 * y)}, 1 / (known * known)});
    }
  return HeightField(heights, {.curvature_sigma = 1});
}

const Eigen::AlignedBox2d kBox(Eigen::Vector2d(-12, -12), Eigen::Vector2d(12, 12));

TEST(GroundHorizon, SparesNoPlaceThatIsHidden) {
  const HeightField field = Humps(0.01);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> across(-12, 12), up(-1, 1.5);
  int num_hidden = 0, num_spared = 0;
  for (int i = 0; i < 40; ++i) {
    const Eigen::Vector3d eye(0.5 * across(random), 0.5 * across(random), 0.8 + up(random));
    const GroundHorizon horizon(field, eye, kBox);
    for (int k = 0; k < 2000; ++k) {
      const Eigen::Vector3d place(across(random), across(random), up(random));
      const bool may_hide = horizon.MayHide(place), is_hidden = IsHidden(field, eye, place);
      EXPECT_TRUE(may_hide || !is_hidden) << place.transpose() << " from " << eye.transpose();
      num_hidden += is_hidden;
      num_spared += !may_hide;
    }
  }
  EXPECT_GT(num_hidden, 5000);
  EXPECT_GT(num_spared, 5000);
}

TEST(GroundHorizon, HardlyAnythingOnEvenGroundIsSuspected) {
  std::vector<HeightObservation> heights;
  for (double x = -12; x < 12; x += 0.2)
    for (double y = -12; y < 12; y += 0.2) heights.push_back({{x, y, 0.04 * x - 0.02 * y}, 1e4});
  const HeightField field(heights, {});
  const GroundHorizon horizon(field, {0, 0, 1}, kBox);
  int count = 0, num_suspected = 0;
  for (double x = -11; x < 11; x += 0.3)
    for (double y = -11; y < 11; y += 0.3, ++count)
      num_suspected += horizon.MayHide({x, y, 0.04 * x - 0.02 * y});
  EXPECT_LT(num_suspected, count / 100) << "the walk along the ray is what it spares";
}

TEST(GroundHorizon, AGuessHidesNothing) {
  const GroundHorizon horizon(Humps(0.2), {0, 0, 1}, kBox);
  EXPECT_FALSE(horizon.MayHide({10, 2, -5}));
}

}  // namespace
}  // namespace parkade
