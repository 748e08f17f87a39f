#pragma once

#include <functional>
#include <vector>

#include "tests/simulator/common/mesh.h"

namespace parkade::simulator {

/// A thing that moves through the scene: a car, or a part of a pedestrian.
struct Mover {
  size_t shape = 0;  ///< index of Movers::shapes
  std::function<Rigid3(double)>
      world_from_mover;  ///< at [s] since the start of the drive; quick, thread-safe
  Eigen::Vector2f half_size =
      Eigen::Vector2f::Zero();  ///< [m] of what it hides the sky from; 0: nothing
  float center = 0;             ///< [m] x of the middle of that
};

/// All that moves but the own car. Materials are the scene's.
struct Movers {
  std::vector<Mesh> shapes;
  std::vector<Mover> movers;
};

}  // namespace parkade::simulator
