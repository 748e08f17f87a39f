#pragma once

#include <vector>

#include "tests/simulator/ground.h"
#include "tests/simulator/lot_layout.h"
#include "tests/simulator/mesh.h"

namespace parkade::simulator {

/// Kerbs, green, parked cars, trees, hedges, lamps, signs, a fence and buildings.
/// Appends what they are made of to `materials`.
Mesh MakeLotObjects(const LotLayout& layout, const Ground& ground, std::uint64_t seed,
                    std::vector<Material>& materials);

}  // namespace parkade::simulator
