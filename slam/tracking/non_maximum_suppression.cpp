#include "slam/tracking/non_maximum_suppression.h"

#include <algorithm>

namespace parkade {

std::vector<size_t> SuppressNonMaxima(const std::vector<Eigen::Vector2d>& pixels, double distance) {
  std::vector<size_t> kept;
  for (size_t i = 0; i < pixels.size(); ++i)
    if (std::none_of(kept.begin(), kept.end(), [&](size_t other) {
          return (pixels[other] - pixels[i]).squaredNorm() < distance * distance;
        }))
      kept.push_back(i);
  return kept;
}

}  // namespace parkade
