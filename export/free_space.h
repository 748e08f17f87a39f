#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/geo.h"
#include "core/surface_map.h"
#include "export/cell_boundary.h"

namespace parkade {

struct FreeSpaceOptions {
  double min_belief =
      0.5;  ///< cells above this are free; unknown ones are not in the map, hence not free
  double max_step = 0.15;  ///< [m] of height between neighboring cells of one sheet: below a kerb
  double min_area = 1.0;   ///< [m^2] smaller sheets are left out
  double deck_height =
      1.8;  ///< [m] between the mean heights of two levels: less than any storey has

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("min_belief", min_belief);
    visit("max_step", max_step);
    visit("min_area", min_area);
    visit("deck_height", deck_height);
  }
  void Validate() const;  ///< throws Error{kUsage}
};

/// One connected piece of free ground that nowhere lies above itself: ground that does, as a garage
/// whose ramps join its decks, is cut at as few heights as possible, where there is the least of
/// it.
struct FreeSheet {
  int level = 0;                                                     ///< 0 is the lowest
  double area = 0, min_height = 0, max_height = 0, mean_height = 0;  ///< [m^2], [m]
  std::vector<Ring> rings;                                           ///< TraceBoundary, [m] in site
};

/// Finds the sheets. Linear in the cells, but for sorting.
std::vector<FreeSheet> FindFreeSheets(const SurfaceMap& surface,
                                      const FreeSpaceOptions& options = {});

/// The level of the sheet that a height [m] belongs to: one whose range of heights holds it, else
/// the one with the nearest mean; 0 without sheets.
int LevelAt(double height, std::span<const FreeSheet> sheets);

/// GeoJSON: one Polygon per sheet. With a datum WGS84 (RFC 7946); without, site meters, said by
/// "frame": "site".
std::string EncodeFreeSpaceGeoJson(const std::vector<FreeSheet>& sheets,
                                   const std::optional<SiteDatum>& datum);

}  // namespace parkade
