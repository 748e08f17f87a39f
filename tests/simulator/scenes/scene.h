#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/simulator/common/lamp.h"
#include "tests/simulator/common/mesh.h"
#include "tests/simulator/ground/ground_canvas.h"
#include "tests/simulator/ground/kerb_stone.h"
#include "tests/simulator/layouts/place.h"
#include "tests/simulator/scenes/mover.h"
#include "tests/simulator/scenes/sky.h"

namespace parkade::simulator {

/// How the surface of a sheet of ground mirrors.
struct GroundFinish {
  float wetness = 0;  ///< 0 dry; 1 dark, with a film of water and puddles
  float gloss = 0;    ///< share of the mirror of a sealed floor
};

/// A world to drive in and to see, everything but the car itself. World: z up, meters;
/// x east, y north.
struct Scene {
  Place place;
  Sky sky;
  std::vector<GroundCanvas> ground_colors = {};  ///< one per sheet of place.ground
  Mesh ground = {};                              ///< the road surface; its material is its sheet
  Mesh objects = {};                             ///< all else that stands still
  std::vector<Material> materials = {};          ///< of `objects` and of the own car
  Mesh own_car = {};                             ///< in body
  Movers movers = {};                            ///< what moves (see AddTraffic)
  LampField lamps = {};                          ///< those that are on
  Color bounce = Gray(0);             ///< irradiance from all sides inside a lit building
  std::vector<KerbStone> kerbs = {};  ///< at the border of `ground`, some behind parked cars
  float sky_reach =
      4;  ///< [m] what is farther away hides no sky; small outdoors, where there is more
  std::vector<GroundFinish> finish = {};  ///< of the sheets of ground; empty: all dry and dull
  bool has_headlights = false;            ///< the own car drives with its lights on
  double usual_exposure = 0.003;          ///< [s] that a camera would choose in this light

  bool IsIndoors() const { return bounce[1] > 0; }
};

}  // namespace parkade::simulator
