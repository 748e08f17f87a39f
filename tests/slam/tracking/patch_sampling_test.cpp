#include "slam/tracking/patch_sampling.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

namespace parkade {
namespace {

constexpr int kEdge = 7;
using Samples = Eigen::Matrix<float, kEdge, kEdge>;

cv::Mat RandomImage() {
  cv::Mat image(40, 50, CV_8UC1);
  cv::RNG random(3);
  random.fill(image, cv::RNG::UNIFORM, 0, 256);
  return image;
}

TEST(PatchSampling, AnUprightGridIsSampledAsAnyOther) {
  const cv::Mat image = RandomImage();
  Eigen::Matrix2d nearly = Eigen::Matrix2d::Identity();
  nearly(0, 1) = 1e-9;  // takes the general way
  for (const Eigen::Vector2d& center :
       {Eigen::Vector2d(20.3, 15.8), Eigen::Vector2d(3.01, 3.01), Eigen::Vector2d(45.9, 35.9)}) {
    Samples upright, general;

    ASSERT_TRUE(SampleGrid<kEdge>(image, center, Eigen::Matrix2d::Identity(), upright));
    ASSERT_TRUE(SampleGrid<kEdge>(image, center, nearly, general));

    EXPECT_LT((upright - general).cwiseAbs().maxCoeff(), 0.01);
  }
}

TEST(PatchSampling, OutsideOfTheImageThereIsNothing) {
  Samples samples;

  EXPECT_FALSE(SampleGrid<kEdge>(RandomImage(), {2.9, 20}, Eigen::Matrix2d::Identity(), samples));
  EXPECT_FALSE(SampleGrid<kEdge>(RandomImage(), {20, 36.1}, Eigen::Matrix2d::Identity(), samples));
}

}  // namespace
}  // namespace parkade
