#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "server/http/json_view.h"
#include "server/store/store.h"
#include "server/store/tables/records.h"

namespace parkade {

/// A drive and a version of its site's map that it is in.
struct DriveInMap {
  Drive drive;
  MapVersion map;
};

/// The version that is asked for (a number), else the latest one made from the drive. Throws
/// Error{kNotFound} for an unknown drive or version, or one without the drive, Error{kConflict}
/// where no map was made of the drive yet, Error{kInvalidInput} for what is no number.
DriveInMap FindDriveInMap(Store& store, const std::string& drive,
                          const std::optional<std::string>& version);

/// A JSON file that the map has of the drive. Throws Error{kConflict} where an older program made
/// the map, which did not write it.
Json ReadJsonOfDrive(const Store& store, const DriveInMap& found, const std::string& name);

}  // namespace parkade
