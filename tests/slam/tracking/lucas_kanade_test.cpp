#include "slam/tracking/lucas_kanade.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "slam/tracking/image_pyramid.h"

namespace parkade {
namespace {

constexpr int kWindow = 17, kLevels = 4;

/// Smooth texture of random blobs, moved by `shift` [px].
cv::Mat Texture(const Eigen::Vector2d& shift) {
  cv::Mat noise(300, 400, CV_8UC1);
  cv::RNG random(5);
  random.fill(noise, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(noise, noise, {}, 2.5);
  cv::normalize(noise, noise, 0, 255, cv::NORM_MINMAX);
  const cv::Mat move = (cv::Mat_<double>(2, 3) << 1, 0, shift.x(), 0, 1, shift.y());
  cv::Mat moved;
  cv::warpAffine(noise, moved, move, noise.size(), cv::INTER_CUBIC, cv::BORDER_REFLECT);
  return moved;
}

TEST(LucasKanade, FindsPointsFromNearAndFarStarts) {
  const Eigen::Vector2d shift(3.3, -1.6);
  const auto from = BuildPyramid(Texture({0, 0}), kWindow, kLevels);
  const auto to = BuildPyramid(Texture(shift), kWindow, kLevels);
  const std::vector<Eigen::Vector2d> before{{100, 100}, {200, 150}, {300, 200}};
  const std::vector<std::optional<Eigen::Vector2d>> start{
      before[0] + shift + Eigen::Vector2d(0.5, 0.5), before[1] + shift + Eigen::Vector2d(-6, 4),
      std::nullopt};

  const auto found = FollowThereAndBack(from, to, before, start, {});

  ASSERT_TRUE(found[0] && found[1]);
  EXPECT_LT((*found[0] - before[0] - shift).norm(), 0.1);
  EXPECT_LT((*found[1] - before[1] - shift).norm(), 0.1);
  EXPECT_FALSE(found[2]);
}

TEST(LucasKanade, LosesWhatIsNoLongerThere) {
  const cv::Mat first = Texture({0, 0});
  cv::Mat second = first.clone();
  cv::flip(second(cv::Rect(160, 110, 80, 80)), second(cv::Rect(160, 110, 80, 80)), -1);
  const auto from = BuildPyramid(first, kWindow, kLevels),
             to = BuildPyramid(second, kWindow, kLevels);
  const std::vector<Eigen::Vector2d> before{{190, 140}, {60, 60}};

  const auto found = FollowThereAndBack(from, to, before, {before[0], before[1]}, {});

  EXPECT_FALSE(found[0] && (*found[0] - before[0]).norm() < 1);
  EXPECT_TRUE(found[1]);
}

}  // namespace
}  // namespace parkade
