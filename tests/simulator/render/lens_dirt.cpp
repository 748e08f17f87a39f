#include "tests/simulator/render/lens_dirt.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

#include "tests/simulator/common/noise.h"
#include "tests/simulator/common/random.h"
#include "tests/simulator/render/cover_lens.h"

namespace parkade::simulator {
namespace {

/// Takes `loss` of the light within `radius` [px] of a place, less towards the rim.
void AddSpot(const cv::Point2f& at, float radius, float loss, cv::Mat& transmission) {
  const int first_row = std::max(0, static_cast<int>(at.y - radius)),
            last_row = std::min(transmission.rows - 1, static_cast<int>(at.y + radius)),
            first = std::max(0, static_cast<int>(at.x - radius)),
            last = std::min(transmission.cols - 1, static_cast<int>(at.x + radius));
  for (int row = first_row; row <= last_row; ++row) {
    for (int column = first; column <= last; ++column) {
      const float away =
          std::hypot(static_cast<float>(column) - at.x, static_cast<float>(row) - at.y) / radius;
      transmission.at<float>(row, column) *= 1 - loss * (1 - SmoothStep(0.4f, 1, away));
    }
  }
}

}  // namespace

LensDirt::LensDirt(double dirt, cv::Size size, std::uint64_t seed) {
  if (dirt <= 0) return;
  constexpr double kSpecks = 90, kDrops = 14;
  Random random(seed, 0xd127);
  const float width = static_cast<float>(size.width);
  transmission_ = cv::Mat(size, CV_32FC1, cv::Scalar(1));
  const auto add = [&](double count, double least, double most, double loss) {
    for (int i = 0; i < static_cast<int>(dirt * count); ++i) {
      const cv::Point2f at(static_cast<float>(random.Uniform()) * width,
                           static_cast<float>(random.Uniform() * size.height));
      AddSpot(at, width * static_cast<float>(random.Uniform(least, most)),
              static_cast<float>(loss * random.Uniform(0.3, 1)), transmission_);
    }
  };
  add(kSpecks, 0.004, 0.015, 0.7);
  add(kDrops, 0.02, 0.06, 0.5);
  // A film that was wiped to one side.
  const float scale = 3 / width;
  const std::uint32_t noise_seed = static_cast<std::uint32_t>(random.Bits());
  for (int row = 0; row < size.height; ++row)
    for (int column = 0; column < size.width; ++column) {
      const float noise = FractalNoise(scale * static_cast<float>(column),
                                       4 * scale * static_cast<float>(row), 4, noise_seed);
      transmission_.at<float>(row, column) *=
          1 - 0.4f * static_cast<float>(dirt) * SmoothStep(0.05f, 0.4f, noise);
    }
}

void LensDirt::Apply(cv::Mat& radiance) const {
  if (transmission_.empty()) return;
  constexpr double kScattered = 0.5;  // of what does not pass
  cv::Mat green;
  cv::extractChannel(radiance, green, 1);
  const cv::Scalar haze = kScattered * cv::mean(radiance, green > 0);  // of what the lens shows
  CoverLens(transmission_,
            {static_cast<float>(haze[0]), static_cast<float>(haze[1]), static_cast<float>(haze[2])},
            radiance);
}

}  // namespace parkade::simulator
