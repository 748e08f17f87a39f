#pragma once

#include "core/site_map.h"
#include "export/lanelet2/lanelet2_map.h"

namespace parkade {

/// MakeExampleMap with kerbs and slots, on the lower deck but for one: four in a row, of which a
/// car hides the last one's ground and the first reaches beyond the free ground; a parallel one;
/// one under that of the upper deck; one that stands askew in the middle of a block that is not
/// free; and one 10 m beside all ground.
SiteMap MakeParkingExample(bool is_georeferenced);

/// What of a map goes into Lanelet2, the slots named as in its slots.geojson.
ParkingMap ParkingMapOf(const SiteMap& map);

}  // namespace parkade
