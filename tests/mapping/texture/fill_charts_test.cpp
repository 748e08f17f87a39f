#include "mapping/texture/fill_charts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

namespace parkade {
namespace {

constexpr double kTexel = 0.02;  // [m]

/// 3 m by 2 m: painted up to x = 1 m, then cells of 4 cm, dark and bright by turns; off the mesh
/// above y = 1.5 m.
TextureChart HalfPainted() {
  TextureChart chart;
  chart.image = cv::Mat(100, 150, CV_8UC3, cv::Scalar());
  chart.mask = cv::Mat(100, 150, CV_8UC1, cv::Scalar(0));
  for (int row = 0; row < 75; ++row)
    for (int column = 0; column < 150; ++column) {
      const bool is_painted = column < 50, is_bright = (row / 2 + column / 2) % 2 == 0;
      chart.mask.at<std::uint8_t>(row, column) =
          is_painted ? TextureChart::kPainted : TextureChart::kPlain;
      chart.image.at<cv::Vec3b>(row, column) =
          is_painted ? cv::Vec3b(60, 70, 80) : cv::Vec3b::all(is_bright ? 160 : 100);
    }
  return chart;
}

TEST(SmoothPlain, LeavesNoSquaresAndNoEdgeToPaintedGround) {
  const TextureChart before = HalfPainted();
  TextureChart chart = HalfPainted();
  SmoothPlain(chart, kTexel);
  const auto color = [&](int row, int column) { return chart.image.at<cv::Vec3b>(row, column); };
  int largest_step = 0;
  for (int row = 1; row < 75; ++row)
    for (int column = 1; column < 150; ++column) {
      if (column < 50) {
        EXPECT_EQ(color(row, column), before.image.at<cv::Vec3b>(row, column));
      }
      for (const cv::Vec3b& other : {color(row - 1, column), color(row, column - 1)})
        largest_step = std::max(largest_step, std::abs(color(row, column)[1] - other[1]));
    }
  EXPECT_LE(largest_step, 12) << "60 before";
  EXPECT_NEAR(color(40, 50)[0], 60, 12);
  for (const int row : {30, 40, 50}) EXPECT_NEAR(color(row, 130)[0], 130, 6) << "the mean of cells";
  EXPECT_EQ(color(80, 130), cv::Vec3b()) << "off the mesh";
}

TEST(SmoothPlain, LeavesWhatIsPaintedAllOver) {
  TextureChart chart = HalfPainted();
  chart.mask.setTo(TextureChart::kPainted);
  const cv::Mat before = chart.image.clone();
  SmoothPlain(chart, kTexel);
  EXPECT_EQ(cv::norm(before, chart.image, cv::NORM_INF), 0);
}

}  // namespace
}  // namespace parkade
