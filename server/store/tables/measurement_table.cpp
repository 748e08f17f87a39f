#include "server/store/tables/measurement_table.h"

#include <nlohmann/json.hpp>
#include <utility>

#include "core/error.h"

namespace parkade {
namespace {

const std::string kSelect =
    "SELECT sequence, id, site, version, kind, title, points, author, created_at FROM "
    "measurements ";

constexpr std::array<std::pair<MeasurementKind, const char*>, 5> kKinds = {
    {{MeasurementKind::kDistance, "distance"},
     {MeasurementKind::kArea, "area"},
     {MeasurementKind::kHeight, "height"},
     {MeasurementKind::kSlope, "slope"},
     {MeasurementKind::kSection, "section"}}};

Measurement FromRow(const Statement& row) {
  Measurement measurement;
  measurement.sequence = row.Integer(0);
  measurement.id = row.Text(1);
  measurement.site = row.Text(2);
  measurement.version = row.Integer(3);
  measurement.kind = MeasurementKindFromText(row.Text(4)).value();
  measurement.title = row.Text(5);
  measurement.points = nlohmann::json::parse(row.Text(6)).get<std::vector<std::array<double, 3>>>();
  measurement.author = row.Text(7);
  measurement.created_at = row.Text(8);
  return measurement;
}

}  // namespace

const char* ToText(MeasurementKind kind) {
  for (const auto& [known, text] : kKinds)
    if (known == kind) return text;
  throw Error(ErrorCode::kInternal, "a kind of measurement without a name");
}

std::optional<MeasurementKind> MeasurementKindFromText(const std::string& text) {
  for (const auto& [kind, known] : kKinds)
    if (text == known) return kind;
  return std::nullopt;
}

void InsertMeasurement(Connection& connection, const Measurement& measurement) {
  connection.Execute(
      "INSERT INTO measurements (id, site, version, kind, title, points, author, created_at) "
      "VALUES (?, ?, ?, ?, ?, ?, ?, ?)",
      measurement.id, measurement.site, measurement.version, std::string(ToText(measurement.kind)),
      measurement.title, nlohmann::json(measurement.points).dump(), measurement.author,
      measurement.created_at);
}

Measurement FindMeasurement(Connection& connection, const std::string& site,
                            const std::string& id) {
  Statement query = connection.Query(kSelect + "WHERE site = ? AND id = ?", site, id);
  Require(query.Step(), ErrorCode::kNotFound,
          "site '" + site + "' has no measurement '" + id + "'");
  return FromRow(query);
}

std::vector<Measurement> ListMeasurements(Connection& connection, const std::string& site,
                                          const std::optional<std::int64_t>& version,
                                          const Page& page) {
  Statement query = connection.Query(
      kSelect +
          "WHERE site = ?1 AND sequence < ?2 AND (?3 IS NULL OR version = ?3) ORDER BY sequence "
          "DESC LIMIT ?4",
      site, page.before, version, page.limit);
  std::vector<Measurement> measurements;
  while (query.Step()) measurements.push_back(FromRow(query));
  return measurements;
}

std::int64_t CountMeasurements(Connection& connection, const std::string& site) {
  Statement query = connection.Query("SELECT count(*) FROM measurements WHERE site = ?", site);
  query.Step();
  return query.Integer(0);
}

void DeleteMeasurement(Connection& connection, const std::string& id) {
  connection.Execute("DELETE FROM measurements WHERE id = ?", id);
}

}  // namespace parkade
