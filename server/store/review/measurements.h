#pragma once

#include <string>
#include <vector>

#include "server/store/store.h"
#include "server/store/tables/measurement_table.h"

namespace parkade {

struct MeasuredValue {
  double value = 0;
  const char* unit = "m";  ///< "m", "m2", "percent"
};

/// What the points of a measurement come to: the length of the line (distance), the area of the
/// polygon as seen from above, the last point's height above the first (height), that per
/// horizontal distance (slope), the line's length as seen from above (section).
MeasuredValue ValueOf(const Measurement& measurement);

/// Keeps a measurement, whose id, author and time are set here. Durable when it returns. Throws
/// Error{kNotFound} for an unknown version, Error{kInvalidInput} for points that make no
/// measurement, Error{kConflict} where the site has too many.
Measurement SaveMeasurement(Store& store, Measurement measurement, const std::string& author);

/// Throws Error{kNotFound}.
void RemoveMeasurement(Store& store, const std::string& site, const std::string& id);

}  // namespace parkade
