#include "server/http/routes/drive_map.h"

#include <algorithm>

#include "core/error.h"
#include "core/files/file.h"
#include "core/files/foreign_json.h"
#include "server/store/tables/drive_table.h"
#include "server/store/tables/map_table.h"

namespace parkade {
namespace {

std::int64_t NumberOf(const std::string& version) {
  const bool is_number =
      version.size() <= 9 && version.find_first_not_of("0123456789") == std::string::npos;
  Require(is_number, ErrorCode::kInvalidInput, "a version is a number, not '" + version + "'");
  return std::stoll(version);
}

}  // namespace

DriveInMap FindDriveInMap(Store& store, const std::string& drive,
                          const std::optional<std::string>& version) {
  return store.database.Read([&](Connection& connection) {
    DriveInMap found{FindDrive(connection, drive), {}};
    if (version) {
      found.map = FindMap(connection, found.drive.site, NumberOf(*version));
    } else {
      Require(found.drive.map_version.has_value(), ErrorCode::kConflict,
              "no map was made of drive '" + drive + "' yet");
      found.map = FindMap(connection, found.drive.site, *found.drive.map_version);
    }
    const bool is_in = std::any_of(found.map.drives.begin(), found.map.drives.end(),
                                   [&](const Drive& of_map) { return of_map.id == drive; });
    Require(is_in, ErrorCode::kNotFound,
            "drive '" + drive + "' is not in version " + std::to_string(found.map.version));
    return found;
  });
}

Json ReadJsonOfDrive(const Store& store, const DriveInMap& found, const std::string& name) {
  const std::string file = found.drive.name + "/" + name;
  const bool is_there = std::any_of(found.map.files.begin(), found.map.files.end(),
                                    [&](const MapFile& of_map) { return of_map.name == file; });
  Require(is_there, ErrorCode::kConflict,
          "version " + std::to_string(found.map.version) +
              " was made by an older program, which did not write " + name +
              ": build the map anew");
  Json json = ParseForeignJson(ReadFile(store.directory.MapFolder(found.map.id) / file));
  Require(!json.is_discarded(), ErrorCode::kInternal, "'" + file + "' of the map is damaged");
  return json;
}

}  // namespace parkade
