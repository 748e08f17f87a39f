#pragma once

#include <Eigen/Core>

namespace parkade::simulator {

/// Linear red, green, blue; the fourth number is ignored and fills a register.
using Color = Eigen::Array4f;

inline Color Rgb(float red, float green, float blue) { return Color(red, green, blue, 0); }
inline Color Gray(float value) { return Color(value, value, value, 0); }

/// Rec. 709 luminance.
inline float Luminance(const Color& color) {
  return 0.2126f * color[0] + 0.7152f * color[1] + 0.0722f * color[2];
}

}  // namespace parkade::simulator
