#pragma once

#include "tests/simulator/layouts/lot_layout.h"
#include "tests/simulator/layouts/place.h"

namespace parkade::simulator {

/// The lot's ground, slots and routes.
Place MakeLotPlace(const LotLayout& layout, const SceneOptions& options);

}  // namespace parkade::simulator
