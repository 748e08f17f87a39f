#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/geo.h"
#include "export/cell_boundary.h"

namespace parkade {

/// The coordinates of a GeoJSON Polygon (RFC 7946), the first position of each ring repeated at its
/// end. With a datum degrees and the ellipsoidal height where known, without one meters in the
/// site.
std::string FormatPolygon(const std::vector<Ring>& rings, const std::optional<SiteDatum>& datum);

/// The coordinates of one position, in the units of FormatPolygon.
std::string FormatPosition(const Eigen::Vector3d& point_in_site,
                           const std::optional<SiteDatum>& datum);

/// A FeatureCollection of features as text. A foreign member says what RFC 7946 has no word for:
/// that coordinates are not WGS84.
std::string FormatFeatureCollection(const std::vector<std::string>& features,
                                    const std::optional<SiteDatum>& datum);

}  // namespace parkade
