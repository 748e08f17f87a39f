#pragma once

#include "tests/simulator/layouts/garage_layout.h"
#include "tests/simulator/layouts/place.h"

namespace parkade::simulator {

/// The ground, slots and routes of the garage. Routes start and end on the forecourt.
Place MakeGaragePlace(const GarageLayout& layout, const SceneOptions& options);

}  // namespace parkade::simulator
