#include "server/ingest/checks/image_noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

namespace parkade {
namespace {

/// Half of it smooth, half of it with a texture of a few pixels, and noise of `sigma` on both.
cv::Mat NoisyImage(double sigma) {
  cv::Mat image(200, 320, CV_32F);
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x)
      image.at<float>(y, x) = static_cast<float>(
          110 + 0.2 * x + (x < 160 ? 0 : 40 * std::sin(1.3 * x) * std::sin(1.7 * y)));
  cv::Mat noise(image.size(), CV_32F);
  cv::RNG random(7);
  random.fill(noise, cv::RNG::NORMAL, 0, sigma);
  cv::Mat noisy;
  cv::Mat(image + noise).convertTo(noisy, CV_8U);
  return noisy;
}

TEST(ImageNoise, IsMeasuredInWhatIsSmooth) {
  for (const double sigma : {2.0, 8.0, 25.0})
    EXPECT_NEAR(ImageNoise(NoisyImage(sigma)), sigma, 0.15 * sigma);
  EXPECT_LT(ImageNoise(NoisyImage(0)), 1);
}

TEST(ImageNoise, BlackAndWhiteAndThumbnailsTellNothing) {
  EXPECT_EQ(ImageNoise(cv::Mat(200, 320, CV_8U, cv::Scalar(0))), 0);
  EXPECT_EQ(ImageNoise(cv::Mat(200, 320, CV_8U, cv::Scalar(255))), 0);
  EXPECT_EQ(ImageNoise(NoisyImage(20)(cv::Rect(0, 0, 64, 48))), 0);
}

}  // namespace
}  // namespace parkade
