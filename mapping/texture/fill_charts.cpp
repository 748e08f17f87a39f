#include "mapping/texture/fill_charts.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "mapping/texture/ground_image.h"

namespace parkade {
namespace {

constexpr double kBlock = 0.05;        // [m] of texels that are taken together
constexpr double kPaintedReach = 0.1;  // [m] sigma of the smoothing of painted ground ...
constexpr double kPlainReach = 0.08;   // ... and of the colors of cells
constexpr float kLeastWeight = 1e-3F;

/// Colors of texels of one kind in blocks, smoothed, times their share; the share is the fourth.
cv::Mat4f SmoothedBlocks(const TextureChart& chart, std::uint8_t kind, int block, double sigma) {
  cv::Mat4f sums((chart.mask.rows + block - 1) / block, (chart.mask.cols + block - 1) / block,
                 cv::Vec4f());
  const float share = 1 / static_cast<float>(block * block);
  for (int row = 0; row < chart.mask.rows; ++row) {
    const auto* mask = chart.mask.ptr<std::uint8_t>(row);
    const auto* color = chart.image.ptr<cv::Vec3b>(row);
    cv::Vec4f* sum = sums[row / block];
    for (int column = 0; column < chart.mask.cols; ++column)
      if (mask[column] == kind) {
        const cv::Vec3b& texel = color[column];
        sum[column / block] += share * cv::Vec4f(texel[0], texel[1], texel[2], 1);
      }
  }
  cv::GaussianBlur(sums, sums, {}, sigma, sigma, cv::BORDER_REFLECT);
  return sums;
}

/// Between blocks, bilinear; at their border outside.
cv::Vec4f At(const cv::Mat4f& blocks, float column, float row) {
  const float x = std::clamp(column, 0.0F, static_cast<float>(blocks.cols - 1)),
              y = std::clamp(row, 0.0F, static_cast<float>(blocks.rows - 1));
  const int left = static_cast<int>(x), top = static_cast<int>(y);
  const int right = std::min(left + 1, blocks.cols - 1),
            bottom = std::min(top + 1, blocks.rows - 1);
  const float u = x - static_cast<float>(left), v = y - static_cast<float>(top);
  return (1 - v) * ((1 - u) * blocks(top, left) + u * blocks(top, right)) +
         v * ((1 - u) * blocks(bottom, left) + u * blocks(bottom, right));
}

}  // namespace

void SmoothPlain(TextureChart& chart, double texel_size) {
  if (cv::countNonZero(chart.mask == TextureChart::kPlain) == 0) return;
  const int block = std::max(1, static_cast<int>(std::lround(kBlock / texel_size)));
  const double size = block * texel_size;
  const cv::Mat4f painted =
      SmoothedBlocks(chart, TextureChart::kPainted, block, kPaintedReach / size);
  const cv::Mat4f plain = SmoothedBlocks(chart, TextureChart::kPlain, block, kPlainReach / size);
  const auto in_blocks = [&](int index) {
    return (static_cast<float>(index) + 0.5F) / static_cast<float>(block) - 0.5F;
  };
  for (int row = 0; row < chart.mask.rows; ++row)
    for (int column = 0; column < chart.mask.cols; ++column) {
      if (chart.mask.at<std::uint8_t>(row, column) != TextureChart::kPlain) continue;
      const cv::Vec4f beside = At(painted, in_blocks(column), in_blocks(row)),
                      own = At(plain, in_blocks(column), in_blocks(row));
      if (own[3] < kLeastWeight) continue;
      // Half of the ground around the rim of painted ground is painted.
      const float share =
          beside[3] < kLeastWeight ? 0 : std::min(1.0F, 2 * beside[3] / (beside[3] + own[3]));
      cv::Vec3b& texel = chart.image.at<cv::Vec3b>(row, column);
      for (int k = 0; k < 3; ++k) {
        const float of_painted = share > 0 ? beside[k] / beside[3] : 0;
        texel[k] = ToByte(share * of_painted + (1 - share) * own[k] / own[3]);
      }
    }
}

void ContinueBeyondBorder(TextureChart& chart) {
  const cv::Mat off = chart.mask == 0;
  cv::Mat distance, nearest;
  if (cv::countNonZero(off) == 0 || cv::countNonZero(chart.mask) == 0) return;
  cv::distanceTransform(off, distance, nearest, cv::DIST_L2, cv::DIST_MASK_5, cv::DIST_LABEL_PIXEL);
  std::vector<cv::Vec3b> color_of(static_cast<std::size_t>(cv::countNonZero(chart.mask)) + 1);
  for (int row = 0; row < chart.mask.rows; ++row)
    for (int column = 0; column < chart.mask.cols; ++column)
      if (chart.mask.at<std::uint8_t>(row, column) != 0)
        color_of[static_cast<std::size_t>(nearest.at<int>(row, column))] =
            chart.image.at<cv::Vec3b>(row, column);
  for (int row = 0; row < chart.mask.rows; ++row)
    for (int column = 0; column < chart.mask.cols; ++column)
      chart.image.at<cv::Vec3b>(row, column) =
          color_of[static_cast<std::size_t>(nearest.at<int>(row, column))];
}

}  // namespace parkade
