#pragma once

#include "tests/simulator/layouts/lot_layout.h"
#include "tests/simulator/layouts/props.h"

namespace parkade::simulator {

/// Kerbs, green, trees, hedges, lamps, signs, a fence, buildings and parked cars. The cars come
/// last, so that all else is the same whatever is parked.
void FurnishLot(const LotLayout& layout, Props& props);

}  // namespace parkade::simulator
