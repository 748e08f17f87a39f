#include "slam/tracking/corner_scores.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "slam/tracking/image_pyramid.h"

namespace parkade {
namespace {

/// Smaller eigenvalue over 8 x 8 px, of which (x, y) is the fifth of the fifth row.
double ScoreAt(const cv::Mat& image, int x, int y) {
  cv::Mat dx, dy;
  cv::Scharr(image, dx, CV_64F, 1, 0, 1.0 / 32);
  cv::Scharr(image, dy, CV_64F, 0, 1, 1.0 / 32);
  const cv::Rect window(x - 4, y - 4, 8, 8);
  const double xx = dx(window).dot(dx(window)) / 64, xy = dx(window).dot(dy(window)) / 64,
               yy = dy(window).dot(dy(window)) / 64;
  return 0.5 * (xx + yy - std::hypot(xx - yy, 2 * xy));
}

TEST(CornerScores, AreSmallerEigenvaluesOfStructureTensors) {
  cv::Mat image(61, 83, CV_8UC1);
  cv::RNG(3).fill(image, cv::RNG::UNIFORM, 0, 256);

  const cv::Mat scores = CornerScores(BuildPyramid(image, 1)[0]);

  ASSERT_EQ(scores.size(), cv::Size(41, 30));
  for (const cv::Point& entry : {cv::Point(2, 2), {20, 11}, {38, 28}})
    EXPECT_NEAR(scores.at<float>(entry), ScoreAt(image, 2 * entry.x, 2 * entry.y), 0.05);
  EXPECT_EQ(scores.at<float>(1, 1), 0);
}

TEST(CornerScores, StrongestCornersDoNotOverflow) {
  cv::Mat image(64, 64, CV_8UC1, cv::Scalar(0));
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x)
      if ((x / 2 + y / 2) % 2 == 0) image.at<std::uint8_t>(y, x) = 255;

  const cv::Mat scores = CornerScores(BuildPyramid(image, 1)[0]);

  EXPECT_NEAR(scores.at<float>(15, 15), ScoreAt(image, 30, 30), 0.5);
  EXPECT_GT(scores.at<float>(15, 15), 100);
}

}  // namespace
}  // namespace parkade
