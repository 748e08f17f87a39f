#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "server/store/tables/database.h"
#include "server/store/tables/records.h"

namespace parkade {

enum class MeasurementKind { kDistance, kArea, kHeight, kSlope, kSection };

/// "distance", "area", ...
const char* ToText(MeasurementKind kind);
std::optional<MeasurementKind> MeasurementKindFromText(const std::string& text);

/// What someone measured in a version, and keeps.
struct Measurement {
  std::int64_t sequence = 0;
  std::string id;
  std::string site;
  std::int64_t version = 0;
  MeasurementKind kind = MeasurementKind::kDistance;
  std::string title;                          ///< one line; may be empty
  std::vector<std::array<double, 3>> points;  ///< [m] in site
  std::string author;
  std::string created_at;
};

// Rows of `measurements`.

void InsertMeasurement(Connection& connection, const Measurement& measurement);

/// Throws Error{kNotFound}.
Measurement FindMeasurement(Connection& connection, const std::string& site, const std::string& id);

/// Newest first; only those of `version` where given.
std::vector<Measurement> ListMeasurements(Connection& connection, const std::string& site,
                                          const std::optional<std::int64_t>& version,
                                          const Page& page);
std::int64_t CountMeasurements(Connection& connection, const std::string& site);

void DeleteMeasurement(Connection& connection, const std::string& id);

}  // namespace parkade
