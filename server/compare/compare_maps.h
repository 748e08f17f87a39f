#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/geo.h"
#include "core/rigid3.h"
#include "core/surface_changes.h"
#include "mapping/evaluation/compare_surfaces.h"
#include "server/compare/align_maps.h"
#include "server/compare/compare_slots.h"
#include "server/map_folder/map_reader.h"

namespace parkade {

/// The distance [m] by which a drive that both versions hold has moved, once their sites are
/// aligned.
struct TrajectoryOffset {
  std::string drive;
  double median = 0, percentile_95 = 0, largest = 0;
};

/// What changed from one version of a map to another, in the later one's site.
struct MapComparison {
  SiteAlignment alignment;
  SurfaceChanges ground;
  SlotChanges slots;  ///< of maps that have them and are aligned well enough to tell a slot from
                      ///< its neighbor
  std::vector<TrajectoryOffset> trajectories;
  std::vector<std::string> added,
      removed;                     ///< drives that only the later or only the earlier map has
  std::optional<SiteDatum> datum;  ///< of the later map
};

/// Compares two maps. Throws Error{kInvalidInput} where a map lacks its surface (an older program
/// made it), and what AlignMaps throws where nothing says how the two lie to each other.
MapComparison CompareMaps(const MapReader& from, const MapReader& to,
                          const CompareOptions& options = {});

/// The whole comparison but for the regions' outlines, as JSON.
std::string EncodeComparison(const MapComparison& comparison);

/// Writes changes.json, changes.geojson, changes.png and changes.pgw into a folder: all of them or
/// nothing.
void WriteComparison(const MapComparison& comparison, const std::filesystem::path& out);

}  // namespace parkade
