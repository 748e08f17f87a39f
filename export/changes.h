#pragma once

#include <optional>
#include <string>

#include "core/geo.h"
#include "core/surface_changes.h"
#include "export/ortho.h"

namespace parkade {

/// GeoJSON: one MultiPolygon per region, with its `change`, `area_m2`, `height_change_m` and `id`:
/// its index in `changes.regions`. With a datum WGS84 (RFC 7946); without, site meters, said by
/// "frame": "site".
std::string EncodeChangesGeoJson(const SurfaceChanges& changes,
                                 const std::optional<SiteDatum>& datum);

/// Ground from above that stayed (gray), was freed (green) or blocked (red), is now mapped (pale
/// green) or no longer (pale red), was raised (violet) or lowered (orange).
Orthophoto RenderChanges(const SurfaceChanges& changes);

}  // namespace parkade
