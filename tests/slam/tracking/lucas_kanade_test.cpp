#include "slam/tracking/lucas_kanade.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "slam/tracking/image_pyramid.h"

namespace parkade {
namespace {

constexpr int kLevels = 4;

/// Smooth texture of random blobs of size `blob` [px], moved by `shift` [px].
cv::Mat Texture(const Eigen::Vector2d& shift, double blob = 2.5) {
  cv::Mat noise(300, 400, CV_8UC1);
  cv::RNG random(5);
  random.fill(noise, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(noise, noise, {}, blob);
  cv::normalize(noise, noise, 0, 255, cv::NORM_MINMAX);
  const cv::Mat move = (cv::Mat_<double>(2, 3) << 1, 0, shift.x(), 0, 1, shift.y());
  cv::Mat moved;
  cv::warpAffine(noise, moved, move, noise.size(), cv::INTER_CUBIC, cv::BORDER_REFLECT);
  return moved;
}

TEST(LucasKanade, FindsPointsFromNearAndFarStarts) {
  const Eigen::Vector2d shift(3.3, -1.6);
  const auto from = BuildPyramid(Texture({0, 0}), kLevels);
  const auto to = BuildPyramid(Texture(shift), kLevels);
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
  const auto from = BuildPyramid(first, kLevels), to = BuildPyramid(second, kLevels);
  const std::vector<Eigen::Vector2d> before{{190, 140}, {60, 60}};

  const auto found = FollowThereAndBack(from, to, before, {before[0], before[1]}, {});

  EXPECT_FALSE(found[0] && (*found[0] - before[0]).norm() < 1);
  EXPECT_TRUE(found[1]);
}

using Pixels = std::vector<Eigen::Vector2d>;

Pixels Lattice() {
  Pixels points;
  for (int y = 40; y < 270; y += 20)
    for (int x = 40; x < 370; x += 20) points.emplace_back(x + 0.3, y + 0.6);
  return points;
}

std::vector<std::optional<Eigen::Vector2d>> FollowFrom(const cv::Mat& first, const cv::Mat& second,
                                                       const Pixels& points, const Pixels& starts) {
  return FollowThereAndBack(BuildPyramid(first, kLevels), BuildPyramid(second, kLevels), points,
                            {starts.begin(), starts.end()}, {});
}

/// [px]
double Rms(const std::vector<std::optional<Eigen::Vector2d>>& found, const Pixels& truth) {
  double sum = 0;
  for (size_t i = 0; i < truth.size(); ++i)
    sum += found[i] ? (*found[i] - truth[i]).squaredNorm() : 1.0;
  return std::sqrt(sum / static_cast<double>(truth.size()));
}

std::vector<std::optional<Eigen::Vector2d>> FollowWithOpenCv(const cv::Mat& first,
                                                             const cv::Mat& second,
                                                             const Pixels& points) {
  std::vector<cv::Point2f> before, after;
  for (const Eigen::Vector2d& point : points)
    before.emplace_back(static_cast<float>(point.x()), static_cast<float>(point.y()));
  std::vector<std::uint8_t> is_found;
  cv::calcOpticalFlowPyrLK(first, second, before, after, is_found, cv::noArray(), {17, 17},
                           kLevels - 1,
                           {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 20, 0.02});
  std::vector<std::optional<Eigen::Vector2d>> found(points.size());
  for (size_t i = 0; i < points.size(); ++i)
    if (is_found[i] != 0) found[i] = Eigen::Vector2d(after[i].x, after[i].y);
  return found;
}

TEST(LucasKanade, IsAsExactAsOpenCvs) {
  const Pixels points = Lattice();
  for (const Eigen::Vector2d& shift :
       {Eigen::Vector2d(0.25, -0.6), Eigen::Vector2d(1.5, 0.9), Eigen::Vector2d(-5.3, 3.7)}) {
    const cv::Mat first = Texture({0, 0}), second = Texture(shift);
    Pixels truth = points;
    for (Eigen::Vector2d& pixel : truth) pixel += shift;

    const double rms = Rms(FollowFrom(first, second, points, points), truth);

    EXPECT_LT(rms, 1.05 * Rms(FollowWithOpenCv(first, second, points), truth));
    EXPECT_LT(rms, 0.1);
  }
}

TEST(LucasKanade, FollowsLargeMotionOverTheCoarseLevels) {
  const Eigen::Vector2d shift(31.3, -18.4);
  const Pixels points{{120, 150}, {200, 180}, {260, 140}};

  const auto found = FollowFrom(Texture({0, 0}, 7), Texture(shift, 7), points, points);

  for (size_t i = 0; i < points.size(); ++i) {
    ASSERT_TRUE(found[i]);
    EXPECT_LT((*found[i] - points[i] - shift).norm(), 0.2);
  }
}

TEST(LucasKanade, FindsNothingOnFlatGround) {
  cv::Mat flat(300, 400, CV_8UC1, cv::Scalar(90));
  cv::rectangle(flat, {200, 0}, {399, 299}, 140, cv::FILLED);  // an edge fixes one coordinate

  const auto found = FollowFrom(flat, flat, {{80, 80}, {200, 150}}, {{80, 80}, {201, 152}});

  EXPECT_FALSE(found[0] || found[1]);
}

TEST(LucasKanade, FollowsPointsAtTheBorderButNotBeyond) {
  const Eigen::Vector2d shift(0.4, 0.3);
  const cv::Mat first = Texture({0, 0}), second = Texture(shift);
  const Pixels points{{9, 9}, {390, 290}, {399, 299}, {0, 150}, {200, 150}};
  Pixels starts = points;
  starts.back() = {1e6, -1e6};

  const auto found = FollowFrom(first, second, points, starts);

  for (size_t i = 0; i < 2; ++i) {
    ASSERT_TRUE(found[i]);
    EXPECT_LT((*found[i] - points[i] - shift).norm(), 0.15);
  }
  EXPECT_FALSE(found.back());
}

TEST(LucasKanade, ChangedBrightnessDoesNotMatterToNormalizedImages) {
  const Eigen::Vector2d shift(1.2, -0.7);
  const Pixels points{{100, 100}, {200, 150}, {300, 200}};
  cv::Mat dim = Texture(shift);
  dim.convertTo(dim, CV_8UC1, 0.6, 15);

  const auto found =
      FollowFrom(NormalizeLocally(Texture({0, 0})), NormalizeLocally(dim), points, points);

  for (size_t i = 0; i < points.size(); ++i) {
    ASSERT_TRUE(found[i]);
    EXPECT_LT((*found[i] - points[i] - shift).norm(), 0.2);
  }
}

}  // namespace
}  // namespace parkade
