#pragma once

#include <string>
#include <vector>

#include "server/map_folder/map_reader.h"
#include "slam/loops/site_graph.h"

namespace parkade {

/// The links between these drives that a finished map was joined by and believed, from its
/// report.json; drives by their index among `names`. A map that an older version of this program
/// made has none. Throws Error{kInvalidInput} where the file is not a report.
std::vector<KeptLink> ReadKeptLinks(const MapReader& map, const std::vector<std::string>& names);

}  // namespace parkade
