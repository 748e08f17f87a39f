#pragma once

#include <vector>

#include "server/map_folder/finished_map.h"
#include "slam/places/place.h"

namespace parkade {

/// What a finished map knows of places along its drives, by drive; Place::odom_from_place is where they lie in its
/// site. Drives without stored places (an older version of this program made the map) are left out.
std::vector<std::vector<Place>> ReadSitePlaces(const FinishedMap& map);

}  // namespace parkade
