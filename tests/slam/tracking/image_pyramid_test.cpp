#include "slam/tracking/image_pyramid.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "tests/slam/worlds/rendered_room.h"

namespace parkade {
namespace {

cv::Mat RoomImage() {
  const RenderedRoom room({-6, -4, 0}, {6, 4, 3}, 3);
  return RoomCamera({PinholeProjection{.fx = 250, .fy = 250, .cx = 159.5, .cy = 119.5}, 320, 240},
                    room)
      .Render({ExpSo3({0, M_PI / 2, 0}), {0, 0, 1}});
}

double MeanDifference(const cv::Mat& a, const cv::Mat& b) {
  return cv::norm(a, b, cv::NORM_L1) / static_cast<double>(a.total());
}

TEST(NormalizeLocally, ExposureAndShadingHardlyMatter) {
  const cv::Mat image = RoomImage();
  cv::Mat darker;
  image.convertTo(darker, CV_8UC1, 0.5, 10);
  cv::Mat shaded = image.clone();
  for (int x = 0; x < image.cols; ++x) shaded.col(x) *= 0.4 + 0.6 * x / image.cols;

  const cv::Mat normalized = NormalizeLocally(image);

  EXPECT_GT(MeanDifference(image, darker), 40);
  EXPECT_LT(MeanDifference(normalized, NormalizeLocally(darker)), 8);
  EXPECT_LT(MeanDifference(normalized, NormalizeLocally(shaded)), 8);
}

TEST(NormalizeLocally, SizesThatAreNoMultipleOfABlockKeepTheirPixelsInPlace) {
  const cv::Mat image = RoomImage()(cv::Rect(0, 0, 315, 237));

  const cv::Mat normalized = NormalizeLocally(image);

  ASSERT_EQ(normalized.size(), image.size());
  const cv::Mat whole = NormalizeLocally(RoomImage())(cv::Rect(0, 0, 280, 200));
  EXPECT_LT(MeanDifference(normalized(cv::Rect(0, 0, 280, 200)), whole), 1.0);
}

TEST(BuildPyramid, HalvesTheImageAndGoesOnBeyondItsEdges) {
  const std::vector<cv::Mat> pyramid = BuildPyramid(RoomImage(), 3);

  ASSERT_EQ(pyramid.size(), 3u);
  EXPECT_EQ(pyramid[1].size(), cv::Size(160, 120));
  EXPECT_EQ(pyramid[2].type(), CV_8UC1);
  for (const cv::Mat& level : pyramid) {
    cv::Mat wide = level;
    wide.adjustROI(kPyramidBorder, kPyramidBorder, kPyramidBorder, kPyramidBorder);
    EXPECT_EQ(wide.cols, level.cols + 2 * kPyramidBorder);
    EXPECT_EQ(wide.at<std::uint8_t>(kPyramidBorder + 7, 0),
              level.at<std::uint8_t>(7, kPyramidBorder));
  }
}

TEST(UsablePixels, LensMaskAndBorderAreLeftOut) {
  const CameraModel fisheye = SurroundFisheye();
  cv::Mat mask(400, 640, CV_8UC1, cv::Scalar(255));
  mask(cv::Rect(300, 350, 40, 50)) = 0;

  const cv::Mat usable = UsablePixels(fisheye, mask, 8);

  EXPECT_EQ(usable.at<std::uint8_t>(200, 320), 255);
  EXPECT_EQ(usable.at<std::uint8_t>(4, 320), 0) << "too near to the border";
  EXPECT_EQ(usable.at<std::uint8_t>(370, 320), 0) << "masked";
  EXPECT_EQ(usable.at<std::uint8_t>(370, 295), 0) << "a patch here would touch the mask";
  EXPECT_EQ(usable.at<std::uint8_t>(370, 280), 255);
}

TEST(IsBlank, BlackWhiteAndCoveredFramesAreBlankDimOnesAreNot) {
  const cv::Mat usable(240, 320, CV_8UC1, cv::Scalar(255));
  cv::Mat noise(240, 320, CV_8UC1), dim;
  cv::RNG random(1);
  random.fill(noise, cv::RNG::NORMAL, 16, 1.0);
  RoomImage().convertTo(dim, CV_8UC1, 0.12);

  EXPECT_TRUE(IsBlank(cv::Mat::zeros(240, 320, CV_8UC1), usable));
  EXPECT_TRUE(IsBlank(cv::Mat(240, 320, CV_8UC1, cv::Scalar(255)), usable));
  EXPECT_TRUE(IsBlank(noise, usable));
  EXPECT_FALSE(IsBlank(dim, usable));
}

}  // namespace
}  // namespace parkade
