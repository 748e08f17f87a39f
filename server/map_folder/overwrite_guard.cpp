#include "server/map_folder/overwrite_guard.h"

#include "core/error.h"
#include "server/map_folder/map_reader.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

/// The folders of a map; none where there is no map.
std::vector<std::string> DrivesOfOldMap(const fs::path& folder) {
  try {
    return MapReader(folder).drives();
  } catch (const Error&) {
    return {};
  }
}

void Refuse(const fs::path& existing) {
  throw Error(ErrorCode::kInvalidInput, "the map would replace '" + existing.string() +
                                            "', which is of no map: choose another folder for it");
}

}  // namespace

void RequireOverwritable(const fs::path& folder, const std::vector<std::string>& drives) {
  std::error_code ignored;
  if (const fs::path tiles = folder / "tiles";
      fs::exists(tiles, ignored) && !fs::is_empty(tiles, ignored))
    if (!fs::exists(folder / "tileset.json", ignored)) Refuse(tiles);
  for (const std::string& drive : drives) {
    const fs::path target = folder / drive;
    if (fs::exists(target, ignored) && !fs::exists(target / "odometry.tum", ignored))
      Refuse(target);
  }
}

void RemoveRestOfOldMap(const fs::path& folder, const fs::path& staging) {
  std::vector<std::string> names = DrivesOfOldMap(folder);
  if (names.empty()) return;
  names.push_back("ortho.tif");
  for (const fs::path name : names)
    if (name.has_filename() && name == name.filename() && name.native().front() != '.' &&
        !fs::exists(staging / name))
      fs::remove_all(folder / name);
}

}  // namespace parkade
