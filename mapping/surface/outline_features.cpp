#include "mapping/surface/outline_features.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace parkade {
namespace {

/// Each about from -1 to 1.
std::array<float, kOutlineFeatures> FeaturesOf(const SurfacePainter::PaintedCell& painted) {
  const float belief = std::clamp(painted.cell.free_belief, 1e-4F, 1 - 1e-4F);
  const float log_odds =
      painted.is_driven ? std::log(belief / (1 - belief)) : painted.shown_log_odds;
  const auto byte = [](std::uint8_t value) { return static_cast<float>(value) / 255; };
  return {1.0F,
          log_odds / 8,
          byte(painted.observations.free),
          byte(painted.observations.occupied),
          painted.is_driven ? 1.0F : 0.0F,
          byte(painted.observations.nearness),
          byte(painted.observations.disagreement),
          static_cast<float>(painted.observations.free_views) / 16,
          static_cast<float>(painted.observations.occupied_views) / 16,
          byte(painted.cell.color[0]) - 0.5F,
          byte(painted.cell.color[1]) - 0.5F,
          byte(painted.cell.color[2]) - 0.5F,
          std::clamp(painted.raised / 0.1F, -2.0F, 2.0F),
          std::clamp(painted.measured / 0.1F, -2.0F, 2.0F),
          painted.certainty};
}

}  // namespace

cv::Rect OutlineWindow(const DeckRaster& deck) {
  return {0, 0, deck.index.cols / kOutlineFactor, deck.index.rows / kOutlineFactor};
}

cv::Mat OutlineFeatures(std::span<const SurfacePainter::PaintedCell> cells, const DeckRaster& deck,
                        const cv::Rect& window) {
  const int shape[] = {1, kOutlineFeatures, window.height, window.width};
  cv::Mat features(4, shape, CV_32F, cv::Scalar(0));
  constexpr float kShare = 1.0F / (kOutlineFactor * kOutlineFactor);
  const cv::Rect inside = window & OutlineWindow(deck);
  for (int row = kOutlineFactor * inside.y; row < kOutlineFactor * (inside.y + inside.height);
       ++row)
    for (int column = kOutlineFactor * inside.x;
         column < kOutlineFactor * (inside.x + inside.width); ++column) {
      const int i = deck.index.at<int>(row, column);
      if (i < 0 || !cells[static_cast<size_t>(i)].is_seen) continue;
      const auto values = FeaturesOf(cells[static_cast<size_t>(i)]);
      for (int channel = 0; channel < kOutlineFeatures; ++channel)
        features.ptr<float>(0, channel,
                            row / kOutlineFactor - window.y)[column / kOutlineFactor - window.x] +=
            kShare * values[static_cast<size_t>(channel)];
    }
  return features;
}

}  // namespace parkade
