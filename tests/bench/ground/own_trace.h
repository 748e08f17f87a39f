#pragma once

#include <opencv2/core/mat.hpp>

#include "core/ground_texture.h"

namespace parkade {

/// What of the own car, body and shadow, a texture shows.
struct OwnTrace {
  double painted = 0;  ///< [m2] by images
  double dark = 0;     ///< [m2] of these, more than 12 % darker than ground without the car
  double bright = 0;   ///< [m2] of these, more than 12 % brighter
  std::vector<cv::Mat1b> is_visible;  ///< per chart, of its size: 255 dark or bright

  /// Of the painted area.
  double Share() const { return painted > 0 ? (dark + bright) / painted : 0; }
};

/// Compares the texture of a drive with that of the same drive by a car that nobody sees, of the
/// same mesh: chart by chart, as means over 10 cm, both at the same mean light. Less than four of
/// 255 levels nobody sees.
OwnTrace FindOwnTrace(const GroundTexture& texture, const GroundTexture& without_car);

}  // namespace parkade
