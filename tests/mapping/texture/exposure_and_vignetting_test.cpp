#include "mapping/texture/exposure_and_vignetting.h"

#include <gtest/gtest.h>

#include <cmath>

namespace parkade {
namespace {

TEST(ExposureAndVignetting, OfAPlainPhotoIsOneEverywhere) {
  EXPECT_EQ(ExposureAndVignetting().At({0, 0}), (std::array<float, 3>{1, 1, 1}));
  EXPECT_EQ(ExposureAndVignetting().At({639, 399}), (std::array<float, 3>{1, 1, 1}));
}

TEST(ExposureAndVignetting, FollowsGainAndFalloffToLessThanAGrayLevel) {
  const Eigen::Array3f gain(1.5F, 1, 0.7F), square(0.4F, 0.3F, 0.2F), fourth(0.5F, 0.6F, 0.7F);
  const ExposureAndVignetting light(gain, {square, fourth}, 640, 400);
  for (float v = 0; v < 400; v += 7)
    for (float u = 0; u < 640; u += 7) {
      const float r2 = ((u - 319.5F) * (u - 319.5F) + (v - 199.5F) * (v - 199.5F)) /
                       (319.5F * 319.5F + 199.5F * 199.5F);
      ASSERT_NEAR(ExposureAndVignetting::SquaredRadius({u, v}, 640, 400), r2, 1e-5);
      for (std::size_t c = 0; c < 3; ++c) {
        const auto i = static_cast<Eigen::Index>(c);
        const float exact = gain[i] * std::exp(square[i] * r2 + fourth[i] * r2 * r2);
        ASSERT_NEAR(light.At({u, v})[c] / exact, 1, 1.0 / 128);
      }
    }
}

}  // namespace
}  // namespace parkade
