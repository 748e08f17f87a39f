#pragma once

#include "tests/simulator/layouts/place.h"
#include "tests/simulator/layouts/street_layout.h"

namespace parkade::simulator {

/// The ground, slots and routes of the street.
Place MakeStreetPlace(const StreetLayout& layout, const SceneOptions& options);

}  // namespace parkade::simulator
