#pragma once

#include <string>

#include "core/option_about.h"
#include "mapping/heights/drive_heights.h"
#include "mapping/heights/height_field.h"
#include "mapping/heights/measure_heights_options.h"

namespace parkade {

/// How FuseSurface makes the ground of a site.
struct SurfaceOptions {
  std::string method =
      "surface";  ///< or "homography": flat ground in voxels, as in the seed paper, to compare
  std::string outlines =
      "network";  ///< corrects those that all observations together draw; or "observations" alone
  double cell_size = 0.05;  ///< [m] of colors and free space; height.spacing must be a multiple
  double max_height_sigma = 0.04;  ///< [m] ground whose height is known less well is not mapped
  double min_island_area =
      200.0;              ///< [m^2] smaller free islands that no car drove on are most often walls
  int latest_drives = 3;  ///< so many of the latest drives that looked at a place decide about it
  double tile_size = 48.0;  ///< [m] of the squares painted two at a time; less takes less memory
  HeightFieldOptions height;
  MeasureHeightsOptions sweep;

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("method", method,
          OptionAbout{"The surface is measured (\"surface\"), or the plane under each pose painted "
                      "(\"homography\")."});
    visit("outlines", outlines,
          OptionAbout{"A network corrects the outlines that all observations together draw "
                      "(\"network\"), or they stand alone (\"observations\")."});
    visit("cell_size", cell_size, OptionAbout{"The edge of a cell of the map.", "m", 0.02, 0.5});
    visit("max_height_sigma", max_height_sigma,
          OptionAbout{"Ground whose height is less sure is not in the map.", "m", 0.005, 1});
    visit("min_island_area", min_island_area,
          OptionAbout{"Free ground that no drive crossed is kept from this area on.", "m^2", 0,
                      100000});
    visit("latest_drives", latest_drives,
          OptionAbout{"The last drives that saw a cell decide about it, this many.", "", 1, 100});
  }
  void Validate() const;  ///< throws Error{kUsage}
  HeightOptions Heights() const { return {height, sweep}; }
};

}  // namespace parkade
