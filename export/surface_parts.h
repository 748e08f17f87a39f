#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/geo.h"
#include "core/surface_map.h"
#include "export/cell_boundary.h"
#include "export/free_space.h"

namespace parkade {

/// A connected piece of what is not for cars, all of one class.
struct SurfacePart {
  SurfaceClass surface = SurfaceClass::kUnknown;
  double area = 0, mean_height = 0;  ///< [m^2], [m]
  std::vector<Ring> rings;           ///< TraceBoundary, [m] in site
};

/// The parts of at least half a square meter, in squares of about 0.2 m that show the class that
/// most of their cells have. No part lies above itself. What images told nothing of is no part.
std::vector<SurfacePart> FindSurfaceParts(const SurfaceMap& surface);

/// GeoJSON: one Polygon per part, in the units of FormatPolygon. Levels are those of the sheets of
/// free space.
std::string EncodeSurfacesGeoJson(const std::vector<SurfacePart>& parts,
                                  std::span<const FreeSheet> sheets,
                                  const std::optional<SiteDatum>& datum);

}  // namespace parkade
