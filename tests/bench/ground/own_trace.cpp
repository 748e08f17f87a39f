#include "tests/bench/ground/own_trace.h"

#include <cassert>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/math/statistics.h"

namespace parkade {
namespace {

constexpr float kVisible = 0.12F;        // of the light
constexpr float kLeastLevels = 4;        // of 255
constexpr double kMean = 0.1;            // [m] over which colors are averaged
constexpr std::size_t kMinTexels = 100;  // of a chart, to know its light

/// Mean lightness of the painted texels around each.
cv::Mat1f LightnessOf(const TextureChart& chart, const cv::Mat& is_painted, int size) {
  cv::Mat gray;
  cv::cvtColor(chart.image, gray, cv::COLOR_BGR2GRAY);
  cv::Mat1f sum, weight;
  cv::Mat1f lightness, painted;
  gray.convertTo(lightness, CV_32F);
  is_painted.convertTo(painted, CV_32F, 1.0 / 255);
  cv::blur(lightness.mul(painted), sum, {size, size});
  cv::blur(painted, weight, {size, size});
  return cv::Mat1f(sum / cv::max(weight, 1e-6));
}

}  // namespace

OwnTrace FindOwnTrace(const GroundTexture& texture, const GroundTexture& without_car) {
  assert(texture.charts.size() == without_car.charts.size());
  const int size = 2 * static_cast<int>(std::lround(0.5 * kMean / texture.texel_size)) + 1;
  const double area = texture.texel_size * texture.texel_size;
  OwnTrace trace;
  for (std::size_t i = 0; i < texture.charts.size(); ++i) {
    const TextureChart &chart = texture.charts[i], &other = without_car.charts[i];
    const cv::Mat1b is_painted((chart.mask == TextureChart::kPainted) &
                               (other.mask == TextureChart::kPainted));
    const cv::Mat1f seen = LightnessOf(chart, is_painted, size),
                    truth = LightnessOf(other, is_painted, size);
    std::vector<float> ratios;
    for (int row = 0; row < seen.rows; ++row)
      for (int column = 0; column < seen.cols; ++column)
        if (is_painted(row, column) != 0 && truth(row, column) > 0)
          ratios.push_back(seen(row, column) / truth(row, column));
    trace.is_visible.emplace_back(cv::Mat1b::zeros(seen.size()));
    if (ratios.size() < kMinTexels) continue;
    trace.painted += area * static_cast<double>(ratios.size());
    const float light = Median(std::move(ratios));
    for (int row = 0; row < seen.rows; ++row)
      for (int column = 0; column < seen.cols; ++column) {
        const float expected = light * truth(row, column), off = seen(row, column) - expected;
        if (is_painted(row, column) == 0 ||
            std::abs(off) < std::max(kLeastLevels, kVisible * expected))
          continue;
        (off < 0 ? trace.dark : trace.bright) += area;
        trace.is_visible.back()(row, column) = 255;
      }
  }
  return trace;
}

}  // namespace parkade
