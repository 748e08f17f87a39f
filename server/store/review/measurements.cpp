#include "server/store/review/measurements.h"

#include <cmath>

#include "core/error.h"
#include "server/store/access/audit_log.h"
#include "server/store/tables/map_table.h"
#include "server/store/tables/names.h"
#include "server/store/tables/text_rules.h"

namespace parkade {
namespace {

using Points = std::vector<std::array<double, 3>>;

constexpr size_t kMaxTitle = 200;                // [bytes]
constexpr size_t kMaxPoints = 200;               // of a measurement
constexpr std::int64_t kMaxMeasurements = 1000;  // of a site
constexpr double kFarthest = 1e7;                // [m] of a point from the site's origin
constexpr double kShortestRun = 1e-3;            // [m] that a slope is measured over

double LengthOf(const Points& points, bool is_horizontal) {
  double length = 0;
  for (size_t i = 1; i < points.size(); ++i) {
    const double dx = points[i][0] - points[i - 1][0], dy = points[i][1] - points[i - 1][1],
                 dz = is_horizontal ? 0 : points[i][2] - points[i - 1][2];
    length += std::hypot(dx, dy, dz);
  }
  return length;
}

/// Seen from above, by the shoelace formula about the first point, which keeps digits.
double AreaOf(const Points& points) {
  double twice = 0;
  for (size_t i = 2; i < points.size(); ++i) {
    const double ax = points[i - 1][0] - points[0][0], ay = points[i - 1][1] - points[0][1];
    const double bx = points[i][0] - points[0][0], by = points[i][1] - points[0][1];
    twice += ax * by - bx * ay;
  }
  return std::abs(twice) / 2;
}

void CheckPoints(MeasurementKind kind, const Points& points) {
  const bool is_pair = kind == MeasurementKind::kHeight || kind == MeasurementKind::kSlope;
  const size_t least = kind == MeasurementKind::kArea ? 3 : 2, most = is_pair ? 2 : kMaxPoints;
  Require(points.size() >= least && points.size() <= most, ErrorCode::kInvalidInput,
          std::string("the measurement '") + ToText(kind) + "' has " +
              (is_pair ? "2" : std::to_string(least) + " to " + std::to_string(most)) + " points");
  for (const auto& point : points)
    for (const double coordinate : point)
      Require(std::isfinite(coordinate) && std::abs(coordinate) <= kFarthest,
              ErrorCode::kInvalidInput, "a point lies too far away to be in the site");
  Require(kind != MeasurementKind::kSlope || LengthOf(points, true) >= kShortestRun,
          ErrorCode::kInvalidInput, "a slope needs points that do not lie above each other");
}

}  // namespace

MeasuredValue ValueOf(const Measurement& measurement) {
  const Points& points = measurement.points;
  const double rise = points.back()[2] - points.front()[2];
  switch (measurement.kind) {
    case MeasurementKind::kDistance: return {LengthOf(points, false), "m"};
    case MeasurementKind::kArea: return {AreaOf(points), "m2"};
    case MeasurementKind::kHeight: return {rise, "m"};
    case MeasurementKind::kSlope: return {100 * rise / LengthOf(points, true), "percent"};
    case MeasurementKind::kSection: return {LengthOf(points, true), "m"};
  }
  throw Error(ErrorCode::kInternal, "a measurement without a kind");
}

Measurement SaveMeasurement(Store& store, Measurement measurement, const std::string& author) {
  CheckText(measurement.title, {.name = "title", .max_bytes = kMaxTitle});
  CheckPoints(measurement.kind, measurement.points);
  measurement.id = NewId();
  measurement.author = author;
  measurement.created_at = NowUtc();
  return store.database.Write([&](Connection& connection) {
    FindMapRow(connection, measurement.site, measurement.version);
    Require(CountMeasurements(connection, measurement.site) < kMaxMeasurements,
            ErrorCode::kConflict,
            "the site has " + std::to_string(kMaxMeasurements) + " measurements: delete some");
    InsertMeasurement(connection, measurement);
    RecordAudit(connection, "measurement.create", measurement.id);
    return FindMeasurement(connection, measurement.site, measurement.id);
  });
}

void RemoveMeasurement(Store& store, const std::string& site, const std::string& id) {
  WriteToMakeRoom(store, [&](Connection& connection) {
    FindMeasurement(connection, site, id);
    DeleteMeasurement(connection, id);
    RecordAudit(connection, "measurement.delete", id);
  });
}

}  // namespace parkade
