#pragma once

#include <functional>

#include "core/rigid3.h"

namespace parkade::simulator {

/// What the mask of an image shows.
enum class Semantics {
  kNone,         ///< there is none
  kDrivable,     ///< 255 = drivable ground
  kLevelGround,  ///< 255 = that and pavements, islands and lawns, as a mistaken network would
  kClasses,      ///< numbers of SurfaceClass; 255 = outside the lens
};

/// One image to take. `world_from_body(offset)` is the pose of the car `offset`
/// seconds after the middle of the exposure of the image's middle row.
struct Shot {
  size_t camera = 0;
  std::function<Rigid3(double)> world_from_body;
  double exposure = 0.003;  ///< [s]
  Semantics semantics = Semantics::kNone;
  double flare = 0;  ///< see LensOptions
  double time = 0;   ///< [s] since the start of the drive, for what moves
};

}  // namespace parkade::simulator
