#pragma once

#include <vector>

#include "tests/simulator/lot_layout.h"
#include "tests/simulator/mesh.h"
#include "tests/simulator/terrain.h"

namespace parkade::simulator {

/// The asphalt as a mesh of quarter-metre steps, the same that the truth is
/// written from. Within 0.2 mm of the terrain.
Mesh MakeLotGround(const LotLayout& layout, const Terrain& terrain);

/// Kerbs, green, parked cars, trees, hedges, lamps, signs, a fence and buildings.
/// Appends what they are made of to `materials`.
Mesh MakeLotObjects(const LotLayout& layout, const Terrain& terrain, std::uint64_t seed,
                    std::vector<Material>& materials);

}  // namespace parkade::simulator
