#include "slam/tracking/reference_patch.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

namespace parkade {
namespace {

cv::Mat Pattern(const Eigen::Affine2d& image_from_pattern, double gain = 1) {
  cv::Mat image(80, 100, CV_8UC1);
  const Eigen::Affine2d pattern_from_image = image_from_pattern.inverse();
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const Eigen::Vector2d p = pattern_from_image * Eigen::Vector2d(x, y);
      const double value = 110 + 40 * std::sin(0.45 * p.x() + 0.1 * p.y()) +
                           40 * std::cos(0.33 * p.y() - 0.2 * p.x()) +
                           15 * std::sin(0.031 * p.x() * p.y());
      image.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(std::lround(gain * value));
    }
  }
  return image;
}

TEST(ReferencePatch, ShiftAndAffineWarpComeBackInSpiteOfGain) {
  const Eigen::Vector2d center(50, 40);
  Eigen::Affine2d now_from_first = Eigen::Affine2d::Identity();
  now_from_first.linear() << 1.15, 0.08, -0.05, 0.93;
  now_from_first.translation() =
      center - now_from_first.linear() * center + Eigen::Vector2d(0.7, -0.45);
  const auto patch = ReferencePatch::Take(Pattern(Eigen::Affine2d::Identity()), center);
  ASSERT_TRUE(patch);

  const auto aligned =
      patch->AlignIn(Pattern(now_from_first, 0.7), center, Eigen::Matrix2d::Identity());

  ASSERT_TRUE(aligned);
  EXPECT_LT((aligned->pixel - now_from_first * center).norm(), 0.05);
  EXPECT_LT((aligned->image_from_reference - now_from_first.linear()).norm(), 0.03);
  EXPECT_GT(aligned->correlation, 0.99);
}

TEST(ReferencePatch, SomethingElseHasNoHighCorrelation) {
  const auto patch = ReferencePatch::Take(Pattern(Eigen::Affine2d::Identity()), {50, 40});
  ASSERT_TRUE(patch);
  const Eigen::Affine2d turned(Eigen::Translation2d(50, 40) * Eigen::Rotation2Dd(2.0) *
                               Eigen::Translation2d(-61, -33));

  const auto aligned = patch->AlignIn(Pattern(turned), {50, 40}, Eigen::Matrix2d::Identity());

  EXPECT_TRUE(!aligned || aligned->correlation < 0.8);
}

TEST(ReferencePatch, FlatPatchesAndTheBorderAreRefused) {
  const cv::Mat image = Pattern(Eigen::Affine2d::Identity());
  const auto patch = ReferencePatch::Take(image, {50, 40});
  ASSERT_TRUE(patch);

  EXPECT_FALSE(ReferencePatch::Take(cv::Mat(80, 100, CV_8UC1, cv::Scalar(90)), {50, 40}));
  EXPECT_FALSE(ReferencePatch::Take(image, {5, 40}));
  EXPECT_FALSE(patch->AlignIn(image, {2, 40}, Eigen::Matrix2d::Identity()));
  EXPECT_FALSE(patch->AlignIn(cv::Mat(80, 100, CV_8UC1, cv::Scalar(90)), {50, 40},
                              Eigen::Matrix2d::Identity()));
}

}  // namespace
}  // namespace parkade
