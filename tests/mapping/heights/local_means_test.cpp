#include "mapping/heights/local_means.h"

#include <gtest/gtest.h>

#include <cmath>

namespace parkade {
namespace {

GroundSample SampleAt(double x, double y, double gray) {
  GroundSample sample;
  sample.point_in_body = Eigen::Vector3f(Eigen::Vector3d(x, y, 0).cast<float>());
  sample.blue = sample.green = sample.red = static_cast<std::uint8_t>(std::lround(gray));
  sample.is_free = true;
  return sample;
}

TEST(LocalMeans, TakesOffShadesAndLeavesWhatIsPainted) {
  std::vector<GroundSample> samples;
  for (double x = -5; x < 5; x += 0.07)
    for (double y = 1; y < 6; y += 0.07)
      samples.push_back(
          SampleAt(x, y, 90 + 7 * x + 5 * y + (std::fmod(x + 100, 0.28) < 0.14 ? 10 : -10)));
  const LocalMeans means(samples, 0.9, 0.9);

  double sum = 0, square = 0, last = 0, jump = 0;
  for (size_t i = 0; i < samples.size(); ++i) {
    const double mean = static_cast<double>(means.At(samples[i]));
    const double rest = static_cast<double>(LocalMeans::GrayOf(samples[i])) - mean;
    sum += rest, square += rest * rest;
    if (i % 72 != 0) jump = std::max(jump, std::abs(mean - last));
    last = mean;
  }

  const auto count = static_cast<double>(samples.size());
  EXPECT_NEAR(sum / count, 0, 0.1);
  EXPECT_NEAR(std::sqrt(square / count), 10, 1) << "the stripes";
  EXPECT_LT(jump, 1.5) << "squares leave no edges";
}

TEST(LocalMeans, OfGroundThatIsNotFreeNothingIsAsked) {
  std::vector<GroundSample> samples{SampleAt(0, 0, 100), SampleAt(0.1, 0, 200)};
  samples[1].is_free = false;

  const LocalMeans means(samples, 0.9, 0.9);

  EXPECT_FALSE(means.WeightOf(samples[1]) > 0);
  EXPECT_NEAR(means.At(samples[0]), 100, 1e-3);
  EXPECT_NO_THROW(LocalMeans({}, 0.9, 0.9));
}

}  // namespace
}  // namespace parkade
