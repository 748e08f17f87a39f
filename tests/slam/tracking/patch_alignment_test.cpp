#include "slam/tracking/patch_alignment.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

namespace parkade {
namespace {

/// A smooth pattern, `gain` * f(image_from_pattern^-1 * pixel).
cv::Mat Pattern(const Eigen::Affine2d& image_from_pattern, double gain = 1) {
  cv::Mat image(80, 100, CV_8UC1);
  const Eigen::Affine2d pattern_from_image = image_from_pattern.inverse();
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const Eigen::Vector2d p = pattern_from_image * Eigen::Vector2d(x, y);
      const double value = 110 + 40 * std::sin(0.55 * p.x() + 0.1 * p.y()) +
                           40 * std::cos(0.43 * p.y() - 0.2 * p.x()) +
                           15 * std::sin(0.031 * p.x() * p.y());
      image.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(std::lround(gain * value));
    }
  }
  return image;
}

TEST(AlignPatch, FindsASubPixelShiftInSpiteOfGain) {
  const Eigen::Vector2d center(50, 40), shift(1.3, -0.85);
  const auto patch =
      MakeTemplate(Pattern(Eigen::Affine2d::Identity()), center, Eigen::Matrix2d::Identity());
  ASSERT_TRUE(patch);

  const auto match =
      AlignPatch(*patch, Pattern(Eigen::Affine2d(Eigen::Translation2d(shift)), 0.6), center, 4);

  ASSERT_TRUE(match);
  EXPECT_LT((match->pixel - center - shift).norm(), 0.06) << "bilinear samples of waves of 11 px";
  EXPECT_GT(match->correlation, 0.99);
}

TEST(AlignPatch, AWarpedTemplateMatchesATurnedAndEnlargedImage) {
  const Eigen::Vector2d center(50, 40);
  Eigen::Affine2d other_from_image = Eigen::Affine2d::Identity();
  other_from_image.linear() = 1.3 * Eigen::Rotation2Dd(0.7).toRotationMatrix();
  other_from_image.translation() =
      center - other_from_image.linear() * center + Eigen::Vector2d(0.6, 0.4);
  const Eigen::Matrix2d image_from_other = other_from_image.linear().inverse();
  const cv::Mat image = Pattern(Eigen::Affine2d::Identity()), other = Pattern(other_from_image);

  const auto warped = MakeTemplate(image, center, image_from_other);
  const auto plain = SamplePatch(image, center, Eigen::Matrix2d::Identity());
  ASSERT_TRUE(warped && plain);
  const auto match = AlignPatch(*warped, other, center, 4);

  ASSERT_TRUE(match);
  EXPECT_LT((match->pixel - other_from_image * center).norm(), 0.05);
  EXPECT_GT(match->correlation, 0.99);
  EXPECT_LT(Correlation(*plain, *SamplePatch(other, match->pixel, Eigen::Matrix2d::Identity())),
            0.8);
}

TEST(MakeTemplate, JacobianAgreesWithFiniteDifferences) {
  const cv::Mat image = Pattern(Eigen::Affine2d::Identity());
  const Eigen::Vector2d center(50, 40);
  const auto patch = MakeTemplate(image, center, Eigen::Matrix2d::Identity());
  ASSERT_TRUE(patch);

  for (int axis = 0; axis < 2; ++axis) {
    const Eigen::Vector2d step =
        Eigen::Vector2d::Unit(axis);  // bilinear samples: exact for central steps of 1 px
    const Patch difference =
        0.5f * (*SamplePatch(image, center + step, Eigen::Matrix2d::Identity()) -
                *SamplePatch(image, center - step, Eigen::Matrix2d::Identity()));
    EXPECT_LT((difference - patch->jacobian.col(axis)).norm(), 0.1f * difference.norm());
  }
}

TEST(MakeTemplate, FlatPatchesEdgesAndTheBorderAreRefused) {
  const cv::Mat flat(80, 100, CV_8UC1, cv::Scalar(90));
  cv::Mat edge = flat.clone();
  edge(cv::Rect(50, 0, 50, 80)) = 200;

  EXPECT_FALSE(MakeTemplate(flat, {50, 40}, Eigen::Matrix2d::Identity()));
  EXPECT_FALSE(MakeTemplate(edge, {50, 40}, Eigen::Matrix2d::Identity()));
  EXPECT_FALSE(SamplePatch(edge, {3, 40}, Eigen::Matrix2d::Identity()));
  EXPECT_FALSE(SamplePatch(edge, {std::nan(""), 40}, Eigen::Matrix2d::Identity()));
}

}  // namespace
}  // namespace parkade
