#pragma once

#include <vector>

#include "slam/places/place.h"

namespace parkade {

/// Place `index` with what `reach` places before and after it saw, in its frame. A point beside the road is seen from
/// several sides, so that a visit from another lane or direction finds it alike; what neighbours both saw is in it more
/// than once.
Place WidenPlace(const std::vector<Place>& places, size_t index, size_t reach);

}  // namespace parkade
