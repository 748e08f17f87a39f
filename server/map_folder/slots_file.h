#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/geo.h"
#include "core/ground_markings.h"
#include "mapping/evaluation/evaluate_slots.h"

namespace parkade {

/// A slot of a finished map.
struct StoredSlot {
  std::string id;
  ParkingSlot slot;                         ///< in the map's site; `states` by name of the drive
  std::map<std::string, SlotState> states;  ///< by drive
};

/// Reads a map's slots.geojson. `datum`: of the map, where it is on Earth. Throws Error{kNotFound}
/// without the file, Error{kInvalidInput} where it is no such file.
std::vector<StoredSlot> ReadSlots(const std::filesystem::path& file,
                                  const std::optional<SiteDatum>& datum);

/// True slots from GeoJSON polygons of four corners, in meters: as parkade-simulate writes them
/// (`center`, `size`, `yaw` in the truth's world), or with "frame": "site", or, with a datum, in
/// WGS84. `is_occupied` says whether a car stands there. Throws Error{kNotFound},
/// Error{kInvalidInput}.
std::vector<TrueSlot> ReadTrueSlots(const std::filesystem::path& file,
                                    const std::optional<SiteDatum>& datum);

}  // namespace parkade
