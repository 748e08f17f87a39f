#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/simulator/ground_canvas.h"
#include "tests/simulator/lot_layout.h"
#include "tests/simulator/mesh.h"
#include "tests/simulator/sky.h"
#include "tests/simulator/terrain.h"

namespace parkade::simulator {

/// A world to drive in, everything but the car itself. World: z up, metres;
/// x east, y north.
struct Scene {
  LotLayout layout;
  Terrain terrain;
  Sky sky;
  GroundCanvas ground_colors;       ///< colours of `ground`
  Mesh ground;                      ///< the asphalt; its materials are not used
  Mesh objects;                     ///< all else that stands still
  std::vector<Material> materials;  ///< of `objects` and of the own car
  Mesh own_car;                     ///< in body
};

struct SceneOptions {
  std::uint64_t seed = 1;
  double relief = 1;           ///< scales the slopes of the ground
  double ground_texel = 0.01;  ///< [m] of painted asphalt; larger is quicker to make
};

/// The scenes that can be built.
const std::vector<std::string>& SceneNames();

/// Throws Error{kUsage} naming the scenes there are for any other name.
Scene BuildScene(const std::string& name, const SceneOptions& options);

}  // namespace parkade::simulator
