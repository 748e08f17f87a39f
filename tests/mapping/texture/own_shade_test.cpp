#include "mapping/texture/own_shade.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace parkade {
namespace {

const WheelbaseFootprint kContact{2.7, 1.55};

TEST(ShadeCaster, ShadesWhatLiesBehindTheCarAsTheSunSeesIt) {
  const ShadeCaster car(kContact);
  const Eigen::Vector3d from_left = Eigen::Vector3d(0, 1, 1).normalized();  // at 45 degrees
  EXPECT_TRUE(car.Shades({1, 0}, from_left)) << "below the car";
  EXPECT_TRUE(car.Shades({1, -1.8}, from_left)) << "the roof at 1.5 m throws it to 2.4 m";
  EXPECT_FALSE(car.Shades({1, -2.7}, from_left));
  EXPECT_FALSE(car.Shades({1, 1.8}, from_left));
  EXPECT_FALSE(car.Shades({6, -1.8}, from_left));
  EXPECT_TRUE(ShadeCaster(kContact, 0.4).Shades({1, -2.7}, from_left));
  EXPECT_FALSE(car.Shades({1, 0}, {0, 1, 0})) << "no sun";
  EXPECT_FALSE(ShadeCaster({}).Shades({1, 0}, from_left)) << "a car of unknown size";
}

/// A drive around a block; what the car shades is darker by `depth`, all by noise, some by others.
std::vector<ShadeSample> Drive(const Eigen::Vector3d& to_sun, double depth, double noise) {
  std::mt19937 random(7);
  std::normal_distribution<float> error(0, static_cast<float>(noise));
  std::uniform_real_distribution<double> around(-8, 10);
  const ShadeCaster car(kContact);
  std::vector<ShadeSample> samples;
  for (int i = 0; i < 4000; ++i) {
    const double heading = std::numbers::pi / 2 * (i / 1000);
    ShadeSample sample;
    sample.place = {around(random), around(random)};
    sample.ground_from_site =
        Eigen::AngleAxisd(-heading, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    const bool is_shaded = car.Shades(sample.place, sample.ground_from_site * to_sun);
    sample.darkness = (is_shaded ? static_cast<float>(depth) : 0.0F) + error(random);
    if (random() % 20 == 0) sample.darkness += 0.4F;  // who passes by
    samples.push_back(sample);
  }
  return samples;
}

TEST(FindSun, FindsWhereTheOwnShadowPoints) {
  for (const double azimuth : {0.3, 2.0, 4.4})
    for (const double elevation : {0.25, 0.6, 0.95}) {
      const Eigen::Vector3d to_sun(std::cos(elevation) * std::cos(azimuth),
                                   std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
      const auto found = FindSun(Drive(to_sun, 0.6, 0.08), kContact);
      ASSERT_TRUE(found) << azimuth << " " << elevation;
      EXPECT_LT(std::acos(std::min(1.0, found->dot(to_sun))), 0.08) << azimuth << " " << elevation;
    }
}

TEST(FindSun, FindsNoneUnderClouds) {
  const Eigen::Vector3d to_sun = Eigen::Vector3d(1, 1, 1).normalized();
  EXPECT_FALSE(FindSun(Drive(to_sun, 0.0, 0.08), kContact));
  EXPECT_FALSE(FindSun(Drive(to_sun, 0.05, 0.08), kContact)) << "hardly any shadow";
  EXPECT_FALSE(FindSun({}, kContact));
  EXPECT_FALSE(FindSun(Drive(to_sun, 0.6, 0.08), {})) << "a car of unknown size";
}

}  // namespace
}  // namespace parkade
