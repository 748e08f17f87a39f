#pragma once

#include <functional>

#include "core/rigid3.h"

namespace parkade::simulator {

/// One image to take. `world_from_body(offset)` is the pose of the car `offset`
/// seconds after the middle of the exposure of the image's middle row.
struct Shot {
  size_t camera = 0;
  std::function<Rigid3(double)> world_from_body;
  double exposure = 0.003;          ///< [s]
  bool with_semantics = false;      ///< also make the mask of drivable ground
  double time = 0;                  ///< [s] since the start of the drive, for what moves
  bool marks_level_ground = false;  ///< the mask shows pavements, islands and lawns, too
};

}  // namespace parkade::simulator
