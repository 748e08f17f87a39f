#pragma once

#include "tests/simulator/common/color.h"
#include "tests/simulator/common/mip_texture.h"

namespace parkade::simulator {

/// What a road is covered with, over the grain and stains that all roads have.
struct RoadLook {
  Color albedo = Rgb(0.1275f, 0.125f, 0.12f);
  TextureKind pattern = TextureKind::kNone;
  float pattern_size = 1;      ///< [m] one period
  float pattern_contrast = 0;  ///< root mean square of relative brightness
};

}  // namespace parkade::simulator
