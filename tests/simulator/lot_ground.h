#pragma once

#include "tests/simulator/ground_canvas.h"
#include "tests/simulator/lot_layout.h"

namespace parkade::simulator {

/// The asphalt of a car park: worn and patched, with cracks, stains, lines,
/// arrows, manholes and litter here, and large plain areas there.
GroundCanvas PaintLot(const LotLayout& layout, double texel_size, std::uint64_t seed);

}  // namespace parkade::simulator
