#include "server/store/review/measurement_export.h"

#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>

#include "server/store/review/measurements.h"
#include "server/store/tables/map_table.h"
#include "server/store/tables/site_table.h"

namespace parkade {
namespace {

using OrderedJson = nlohmann::ordered_json;

std::optional<SiteDatum> DatumOf(const MapVersion& map) {
  if (!map.datum) return std::nullopt;
  const OrderedJson json = OrderedJson::parse(*map.datum, nullptr, /*allow_exceptions=*/false);
  if (!json.is_object()) return std::nullopt;
  return SiteDatum{.latitude_deg = json.value("latitude_deg", 0.0),
                   .longitude_deg = json.value("longitude_deg", 0.0),
                   .altitude = json.value("altitude", 0.0),
                   .is_altitude_known = json.value("is_altitude_known", true)};
}

OrderedJson PositionOf(const std::array<double, 3>& point, const std::optional<SiteDatum>& datum) {
  if (!datum) return point;
  const Geodetic place = GeodeticFromSite(*datum, {point[0], point[1], point[2]});
  if (!datum->is_altitude_known) return {place.longitude_deg, place.latitude_deg};
  return {place.longitude_deg, place.latitude_deg, place.altitude};
}

OrderedJson FeatureOf(const PlacedMeasurement& placed) {
  const Measurement& measurement = placed.measurement;
  OrderedJson positions = OrderedJson::array();
  for (const auto& point : measurement.points) positions.push_back(PositionOf(point, placed.datum));
  const bool is_area = measurement.kind == MeasurementKind::kArea;
  if (is_area) {
    positions.push_back(positions.front());
    positions = OrderedJson::array({positions});
  }
  const MeasuredValue value = ValueOf(measurement);
  return {{"type", "Feature"},
          {"id", measurement.id},
          {"properties",
           {{"kind", ToText(measurement.kind)},
            {"title", measurement.title},
            {"version", measurement.version},
            {"value", value.value},
            {"unit", value.unit},
            {"frame", placed.datum ? "wgs84" : "site"},
            {"author", measurement.author},
            {"created_at", measurement.created_at}}},
          {"geometry", {{"type", is_area ? "Polygon" : "LineString"}, {"coordinates", positions}}}};
}

std::string Quoted(const std::string& text) {
  const bool is_formula = !text.empty() && std::string("=+-@").find(text[0]) != std::string::npos;
  std::string quoted = is_formula ? "\"'" : "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

std::string Fixed(double value, int digits) {
  std::array<char, 400> text{};
  std::snprintf(text.data(), text.size(), "%.*f", digits, value);
  return text.data();
}

/// "latitude,longitude,height", empty where they are not known.
std::string PlaceOf(const std::array<double, 3>& point, const std::optional<SiteDatum>& datum) {
  if (!datum) return ",,";
  const Geodetic place = GeodeticFromSite(*datum, {point[0], point[1], point[2]});
  return Fixed(place.latitude_deg, 9) + "," + Fixed(place.longitude_deg, 9) + "," +
         (datum->is_altitude_known ? Fixed(place.altitude, 3) : "");
}

}  // namespace

std::vector<PlacedMeasurement> PlacedMeasurements(Connection& connection, const std::string& site,
                                                  const std::optional<std::int64_t>& version) {
  FindSite(connection, site);
  std::map<std::int64_t, std::optional<SiteDatum>> datums;
  std::vector<PlacedMeasurement> placed;
  const Page all{.limit = static_cast<int>(CountMeasurements(connection, site))};
  for (Measurement& measurement : ListMeasurements(connection, site, version, all)) {
    const auto [found, is_new] = datums.try_emplace(measurement.version);
    if (is_new) found->second = DatumOf(FindMapRow(connection, site, measurement.version));
    placed.push_back({std::move(measurement), found->second});
  }
  return placed;
}

std::string FormatGeoJson(const std::vector<PlacedMeasurement>& measurements) {
  OrderedJson json = {{"type", "FeatureCollection"}, {"features", OrderedJson::array()}};
  for (const PlacedMeasurement& placed : measurements)
    json["features"].push_back(FeatureOf(placed));
  return json.dump() + "\n";
}

std::string FormatCsv(const std::vector<PlacedMeasurement>& measurements) {
  std::string text =
      "id,kind,title,version,value,unit,author,created_at,point,x,y,z,latitude,longitude,"
      "height\r\n";
  for (const PlacedMeasurement& placed : measurements) {
    const Measurement& measurement = placed.measurement;
    const MeasuredValue value = ValueOf(measurement);
    const std::string head = measurement.id + "," + ToText(measurement.kind) + "," +
                             Quoted(measurement.title) + "," + std::to_string(measurement.version) +
                             "," + Fixed(value.value, 4) + "," + value.unit + "," +
                             Quoted(measurement.author) + "," + measurement.created_at + ",";
    for (size_t i = 0; i < measurement.points.size(); ++i) {
      const auto& [x, y, z] = measurement.points[i];
      text += head + std::to_string(i + 1) + "," + Fixed(x, 4) + "," + Fixed(y, 4) + "," +
              Fixed(z, 4) + "," + PlaceOf(measurement.points[i], placed.datum) + "\r\n";
    }
  }
  return text;
}

}  // namespace parkade
