#include "slam/tracking/flow_patch.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "slam/tracking/image_pyramid.h"

namespace parkade {
namespace {

static_assert(kPyramidBorder >= flow::kReadColumns && kPyramidBorder > FlowPatch::kMaxEdge);

constexpr float kMinCurvature =
    0.1024f;  ///< [(gray levels / px)^2] mean, smaller eigenvalue (OpenCV's 1e-4)

/// Samples of which the first is at `first` [px].
flow::SampledRows RowsAt(const cv::Mat& image, const cv::Point2f& first, int rows, int stride) {
  constexpr float kOne = 1 << flow::kShareBits;
  const float x = std::floor(first.x), y = std::floor(first.y);
  const auto share = [](float part) {
    return static_cast<std::int16_t>(std::min(kOne * part, kOne - 1));
  };
  const auto step = static_cast<std::ptrdiff_t>(image.step[0]);
  return {image.data + static_cast<std::ptrdiff_t>(y) * step + static_cast<std::ptrdiff_t>(x),
          step,
          share(first.x - x),
          share(first.y - y),
          rows,
          stride};
}

}  // namespace

FlowPatch::FlowPatch(int edge) : edge_(edge) {
  assert(edge > 0 && edge <= kMaxEdge && edge % 2 == 1);
  for (int row = 0; row < edge; ++row)
    std::fill_n(is_inside_.data() + row * Stride(), edge, std::int16_t{-1});
}

bool FlowPatch::IsInside(const cv::Mat& image, const cv::Point2f& center) const {
  const float half = 0.5f * static_cast<float>(edge_ - 1), edge = static_cast<float>(edge_);
  const float x = center.x - half, y = center.y - half;
  return x >= -edge && x < static_cast<float>(image.cols) && y >= -edge &&
         y < static_cast<float>(image.rows);
}

bool FlowPatch::Take(const cv::Mat& image, const cv::Point2f& center) {
  if (!IsInside(image, center)) return false;
  const float reach = 0.5f * static_cast<float>(edge_ + 1);
  flow::Sample(RowsAt(image, center - cv::Point2f(reach, reach), Stride(), Stride()), samples_);
  flow::Differentiate(samples_, is_inside_, edge_, Stride(), slopes_x_, slopes_y_);
  const flow::Products sum = flow::SumProducts(slopes_x_, slopes_y_, edge_ * Stride());

  constexpr float kUnit = 1.0f / (1 << 2 * flow::kSlopeBits);
  const float xx = kUnit * static_cast<float>(sum.xx), xy = kUnit * static_cast<float>(sum.xy),
              yy = kUnit * static_cast<float>(sum.yy);
  const float smaller = 0.5f * (xx + yy - std::hypot(xx - yy, 2 * xy));
  if (smaller < kMinCurvature * static_cast<float>(edge_ * edge_)) return false;
  const float scale = 1 / (xx * yy - xy * xy);
  inverse_ = {scale * yy, -scale * xy, -scale * xy, scale * xx};
  return true;
}

std::optional<cv::Point2f> FlowPatch::StepFrom(const cv::Mat& image,
                                               const cv::Point2f& center) const {
  if (!IsInside(image, center)) return std::nullopt;
  constexpr float kUnit = 1.0f / (1 << (flow::kMoreBits + flow::kSlopeBits));
  const float half = 0.5f * static_cast<float>(edge_ - 1);
  const flow::Mismatch more =
      flow::Compare(RowsAt(image, center - cv::Point2f(half, half), edge_, Stride()),
                    samples_.data() + Stride() + 1, slopes_x_, slopes_y_);
  const cv::Vec2f step = inverse_ * cv::Vec2f(-kUnit * static_cast<float>(more.x),
                                              -kUnit * static_cast<float>(more.y));
  return cv::Point2f(step);
}

}  // namespace parkade
