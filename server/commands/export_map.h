#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "export/occupancy_grid.h"
#include "server/map_folder/map_reader.h"

namespace parkade {

/// Options of `parkade export` beyond the format.
struct ExportOptions {
  std::string drive;     ///< of trajectory formats; may be empty where the map has one drive
  double spacing = 0.1;  ///< [m] between the points of a point cloud
  OccupancyGridOptions grid;
  std::optional<int> level = {};  ///< of lanelet2: this one alone
};

/// One format: its name on the command line and what it is.
struct ExportFormat {
  std::string name;
  std::string description;
  bool is_folder = false;
};

/// All formats in the order of --help.
const std::vector<ExportFormat>& ExportFormats();

/// Writes one export of a finished map to `out`: a file, or a folder where the format has several
/// files. Whole or not at all. Throws Error{kUsage} naming the formats for any other, and what
/// MapReader throws.
void ExportMap(const MapReader& map, const std::string& format, const std::filesystem::path& out,
               const ExportOptions& options = {});

}  // namespace parkade
