#include "mapping/texture/calibrate_photometry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace parkade {
namespace {

constexpr float kPriorError = 0.1F;  // of a log-gain that cells tell

/// Images along a line, each of which shows the places around it; two lenses.
struct Row {
  std::vector<LightPrior> images;
  std::vector<Eigen::Array3f> log_gains;  // that undo the exposures
  std::vector<ExposureAndVignetting::Falloff> falloffs;
  std::vector<LightPlace> places;
};

Row MakeRow(double noise, double share_of_outliers) {
  constexpr std::uint32_t kNumImages = 40, kNumPlaces = 400, kReach = 60;
  std::mt19937 generator(7);
  std::normal_distribution<float> normal;
  std::uniform_real_distribution<float> uniform;
  Row row;
  row.falloffs = {{Eigen::Array3f(0.3F, 0.4F, 0.5F), Eigen::Array3f(0.2F, 0.1F, 0.3F)},
                  {Eigen::Array3f(0.1F, 0.2F, 0.1F), Eigen::Array3f(0.5F, 0.4F, 0.6F)}};
  for (std::uint32_t i = 0; i < kNumImages; ++i) {
    row.log_gains.push_back(
        0.3F * Eigen::Array3f(normal(generator), normal(generator), normal(generator)));
    row.images.push_back({i % 2, row.log_gains.back() + kPriorError * normal(generator)});
  }
  for (std::uint32_t p = 0; p < kNumPlaces; ++p) {
    const Eigen::Array3f own =
        4 + 0.4F * Eigen::Array3f(normal(generator), normal(generator), normal(generator));
    LightPlace& place = row.places.emplace_back();
    for (std::uint32_t i = 0; i < kNumImages; ++i) {
      if (std::abs(static_cast<double>(p) - 10.0 * i) > kReach) continue;
      const float square = uniform(generator);
      const ExposureAndVignetting::Falloff& falloff = row.falloffs[i % 2];
      LightObservation observation{
          i, 0.1F + 0.9F * uniform(generator), square,
          own - row.log_gains[i] - square * falloff[0] - square * square * falloff[1]};
      for (float& channel : observation.log_color)
        channel += static_cast<float>(noise) * normal(generator);
      if (uniform(generator) < share_of_outliers) observation.log_color += 1;
      place.Add(observation);
    }
  }
  return row;
}

/// Of gains against the true ones, whatever they have in common: root mean square, in log.
double GainError(const Row& row, const PhotometricCalibration& light) {
  Eigen::Array3d sum = Eigen::Array3d::Zero(), squares = Eigen::Array3d::Zero();
  const auto count = static_cast<double>(row.images.size());
  for (std::size_t i = 0; i < row.images.size(); ++i) {
    const Eigen::Array3d off = (light.gains[i].log() - row.log_gains[i]).cast<double>();
    sum += off;
    squares += off.square();
  }
  return std::sqrt((squares / count - (sum / count).square()).mean());
}

TEST(CalibratePhotometry, FindsExposuresAndLenses) {
  const Row row = MakeRow(0.02, 0.1);

  const PhotometricCalibration light = CalibratePhotometry(row.images, row.places);

  ASSERT_EQ(light.gains.size(), row.images.size());
  ASSERT_EQ(light.falloffs.size(), 2u);
  EXPECT_LT(GainError(row, light), 0.5 * kPriorError)
      << "of exposures that differ by 0.3; one observation in ten is of something else";
  for (std::size_t lens = 0; lens < 2; ++lens)
    for (const float square : {0.25F, 0.5F, 1.0F}) {
      const auto at = [&](const ExposureAndVignetting::Falloff& falloff) -> Eigen::Array3f {
        return square * falloff[0] + square * square * falloff[1];
      };
      EXPECT_LT((at(light.falloffs[lens]) - at(row.falloffs[lens])).abs().maxCoeff(), 0.05);
    }
}

TEST(CalibratePhotometry, LeavesHardlyADifference) {
  const Row row = MakeRow(0.02, 0);
  const ExposureAndVignetting::Falloff none{Eigen::Array3f::Zero(), Eigen::Array3f::Zero()};
  PhotometricCalibration before{{}, {none, none}};
  for (const LightPrior& image : row.images) before.gains.push_back(image.log_gain.exp());

  EXPECT_GT(LightDisagreement(row.images, row.places, before), 0.15);
  EXPECT_LT(LightDisagreement(row.images, row.places, CalibratePhotometry(row.images, row.places)),
            0.05);
}

TEST(CalibratePhotometry, StaysAtThePriorsWhereNothingTells) {
  std::vector<LightPrior> images(3);
  images[1].log_gain = Eigen::Array3f(0.1F, 0.2F, 0.3F);
  LightPlace alone;
  alone.Add({1, 0.5F, 0.5F, Eigen::Array3f::Constant(4)});

  const PhotometricCalibration light = CalibratePhotometry(images, {alone});

  EXPECT_TRUE(light.gains[1].isApprox(images[1].log_gain.exp(), 1e-4F));
  EXPECT_TRUE(light.gains[2].isApproxToConstant(1, 1e-4F));
  EXPECT_TRUE(CalibratePhotometry({}, {alone}).gains.empty());
}

TEST(LightPlace, KeepsTheSteepestObservations) {
  LightPlace place;
  for (const float weight : {0.3F, 0.1F, 0.9F, 0.2F, 0.8F, 0.7F, 0.4F, 0.6F, 0.5F, 0.0F})
    place.Add({0, weight, 0, Eigen::Array3f::Zero()});
  for (std::size_t i = 0; i < LightPlace::kNumObservations; ++i)
    EXPECT_FLOAT_EQ(place.observations()[i].weight, 0.9F - 0.1F * static_cast<float>(i));
}

}  // namespace
}  // namespace parkade
