#include "slam/tracking/corner_detector.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "slam/tracking/image_pyramid.h"

namespace parkade {
namespace {

bool Always(const Eigen::Vector2d&) { return true; }

/// White squares of 24 px on black, 64 px apart: corners are known.
cv::Mat Squares(int width, int height) {
  cv::Mat image(height, width, CV_8UC1, cv::Scalar(40));
  for (int y = 20; y + 24 < height; y += 64)
    for (int x = 20; x + 24 < width; x += 64) image(cv::Rect(x, y, 24, 24)) = 200;
  return image;
}

cv::Mat Everywhere(const cv::Mat& image) { return cv::Mat(image.size(), CV_8UC1, cv::Scalar(255)); }

class CornersAtScale : public testing::TestWithParam<int> {};

TEST_P(CornersAtScale, CornersOfSquaresAreFoundAndEdgesAreNot) {
  const cv::Mat image = Squares(GetParam(), 480);

  const auto corners = CornerDetector(Everywhere(image), 300)
                           .Detect(BuildPyramid(image, 3), Everywhere(image), {}, Always);

  ASSERT_GT(corners.size(), 50u);
  for (const Eigen::Vector2d& corner : corners) {
    const auto off = [](double value) {
      const double in_tile = std::fmod(value - 20, 64);
      return std::min(std::abs(in_tile), std::abs(in_tile - 24));
    };
    EXPECT_LE(off(corner.x()), 6) << corner.transpose();
    EXPECT_LE(off(corner.y()), 6) << corner.transpose();
  }
}

INSTANTIATE_TEST_SUITE_P(FullAndHalfSize, CornersAtScale, testing::Values(640, 1280));

TEST(CornerDetector, DistanceBudgetMaskAndWishesAreKept) {
  cv::Mat image(400, 640, CV_8UC1);
  cv::RNG(1).fill(image, cv::RNG::UNIFORM, 0, 255);
  cv::GaussianBlur(image, image, {}, 2);
  cv::Mat usable = Everywhere(image);
  usable(cv::Rect(0, 0, 640, 100)) = 0;
  const CornerDetector detector(usable, 100);
  std::vector<Eigen::Vector2d> all = {{300, 300}, {305, 200}};

  const auto corners =
      detector.Detect(BuildPyramid(NormalizeLocally(image), 3), usable, all,
                      [](const Eigen::Vector2d& pixel) { return pixel.x() < 600; });

  EXPECT_LE(corners.size(), 98u);
  EXPECT_GE(corners.size(), 85u);
  all.insert(all.end(), corners.begin(), corners.end());
  for (size_t i = 2; i < all.size(); ++i) {
    EXPECT_GE(all[i].y(), 100);
    EXPECT_LT(all[i].x(), 600);
    for (size_t j = 0; j < i; ++j) EXPECT_GT((all[i] - all[j]).norm(), detector.min_distance() - 3);
  }
}

TEST(CornerDetector, AFaintCornerOfADarkCellIsTaken) {
  cv::Mat image(400, 640, CV_8UC1, cv::Scalar(10));
  image(cv::Rect(500, 300, 40, 40)) = 24;
  cv::Mat noise(image.size(), CV_8UC1);
  cv::RNG(2).fill(noise, cv::RNG::NORMAL, 3, 1);
  image += noise;

  const auto corners =
      CornerDetector(Everywhere(image), 150)
          .Detect(BuildPyramid(NormalizeLocally(image), 3), Everywhere(image), {}, Always);

  EXPECT_GE(corners.size(), 3u);
  for (const Eigen::Vector2d& corner : corners)
    EXPECT_LT((corner - Eigen::Vector2d(520, 320)).cwiseAbs().maxCoeff(), 30)
        << "noise is no corner";
}

TEST(CornerDetector, AFullImageAndAFlatImageGetNone) {
  const cv::Mat flat(400, 640, CV_8UC1, cv::Scalar(90));
  const CornerDetector detector(Everywhere(flat), 10);

  EXPECT_TRUE(detector.Detect(BuildPyramid(flat, 3), Everywhere(flat), {}, Always).empty());
  const std::vector<Eigen::Vector2d> full(10, {100, 100});
  EXPECT_TRUE(
      detector.Detect(BuildPyramid(Squares(640, 400), 3), Everywhere(flat), full, Always).empty());
}

}  // namespace
}  // namespace parkade
