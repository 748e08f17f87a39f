#pragma once

#include "tests/simulator/lot_layout.h"
#include "tests/simulator/place.h"

namespace parkade::simulator {

/// The lot's ground, slots and routes.
Place MakeLotPlace(const LotLayout& layout, const SceneOptions& options);

}  // namespace parkade::simulator
