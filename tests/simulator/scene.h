#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/simulator/ground_canvas.h"
#include "tests/simulator/mesh.h"
#include "tests/simulator/place.h"
#include "tests/simulator/sky.h"

namespace parkade::simulator {

/// A world to drive in and to see, everything but the car itself. World: z up, metres;
/// x east, y north.
struct Scene {
  Place place;
  Sky sky;
  std::vector<GroundCanvas> ground_colors;  ///< one per sheet of place.ground
  Mesh ground;                              ///< the road surface; its material is its sheet
  Mesh objects;                             ///< all else that stands still
  std::vector<Material> materials;          ///< of `objects` and of the own car
  Mesh own_car;                             ///< in body
};

/// The place of these options with all that is to be seen there. Throws as PlanPlace.
Scene BuildScene(const std::string& name, const SceneOptions& options);

}  // namespace parkade::simulator
