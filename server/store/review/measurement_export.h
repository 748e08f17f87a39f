#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/geo.h"
#include "server/store/tables/measurement_table.h"

namespace parkade {

/// A measurement with the place on Earth of the version that it was made in.
struct PlacedMeasurement {
  Measurement measurement;
  std::optional<SiteDatum> datum;  ///< nothing: the version has none
};

/// All measurements of a site, newest first; only those of `version` where given.
std::vector<PlacedMeasurement> PlacedMeasurements(Connection& connection, const std::string& site,
                                                  const std::optional<std::int64_t>& version);

/// A GeoJSON feature for each: in degrees and the height above the ellipsoid ("frame": "wgs84";
/// without the height where nobody said how high the site lies), or in meters of the site frame
/// where there is no datum ("frame": "site").
std::string FormatGeoJson(const std::vector<PlacedMeasurement>& measurements);

/// A line of CSV (RFC 4180) for each point, after a header. No field of a user's begins as a
/// formula would.
std::string FormatCsv(const std::vector<PlacedMeasurement>& measurements);

}  // namespace parkade
