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

/// No neighbor is higher, and none before it in reading order as high.
bool IsPeak(const cv::Mat& scores, int y, int x, float least) {
  const float score = scores.at<float>(y, x);
  if (score < least) return false;
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx) {
      const float other = scores.at<float>(y + dy, x + dx);
      if (other > score || (other == score && (dy < 0 || (dy == 0 && dx < 0)))) return false;
    }
  return true;
}

TEST(FindPeaks, AreThoseThatOneLookAtEachFinds) {
  for (const int num_values : {3, 40, 100000})  // few: many neighbors are equal
    for (const cv::Size& size : {cv::Size(67, 41), cv::Size(16, 5), cv::Size(3, 3)}) {
      cv::Mat scores(size, CV_32FC1);
      cv::RNG random(static_cast<std::uint64_t>(num_values));
      for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x)
          scores.at<float>(y, x) = static_cast<float>(random.uniform(0, num_values));
      const float least = 0.4F * static_cast<float>(num_values);

      const cv::Mat is_peak = FindPeaks(scores, least);

      for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x) {
          const bool is_inside = x > 0 && y > 0 && x + 1 < size.width && y + 1 < size.height;
          ASSERT_EQ(is_peak.at<std::uint8_t>(y, x) != 0, is_inside && IsPeak(scores, y, x, least))
              << x << ", " << y;
        }
    }
  EXPECT_EQ(cv::countNonZero(FindPeaks(cv::Mat::zeros(0, 0, CV_32FC1), 1)), 0);
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
