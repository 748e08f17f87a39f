#include "core/error.h"
#include "server/http/json_response.h"
#include "server/http/routes/json_body.h"
#include "server/http/routes/review_view.h"
#include "server/http/routes/routes.h"
#include "server/store/review/measurement_export.h"
#include "server/store/review/measurements.h"
#include "server/store/tables/site_table.h"

namespace parkade {
namespace {

std::optional<std::int64_t> VersionParameter(const httplib::Request& request) {
  const auto text = QueryParameter(request, "version");
  if (!text) return std::nullopt;
  Require(text->size() <= 9 && text->find_first_not_of("0123456789") == std::string::npos,
          ErrorCode::kInvalidInput, "'version' is the number of one");
  return std::stoll(*text);
}

/// All of a site in one answer: it has at most a thousand.
void Export(RouteContext& context, const httplib::Request& request, const std::string& format,
            httplib::Response& response) {
  const std::string site = request.matches[1];
  const auto version = VersionParameter(request);
  const auto placed = context.store.database.Read(
      [&](Connection& connection) { return PlacedMeasurements(connection, site, version); });
  const bool is_csv = format == "csv";
  response.status = 200;
  response.set_header("Cache-Control", "no-store");
  response.set_header("Content-Disposition", "attachment; filename=\"" + site + "-measurements." +
                                                 (is_csv ? "csv" : "geojson") + "\"");
  response.set_content(is_csv ? FormatCsv(placed) : FormatGeoJson(placed),
                       ContentTypeOf(is_csv ? ".csv" : ".geojson"));
}

void List(RouteContext& context, const httplib::Request& request, httplib::Response& response) {
  const std::string format = QueryParameter(request, "format").value_or("json");
  Require(format == "json" || format == "geojson" || format == "csv", ErrorCode::kInvalidInput,
          "measurements come as json, geojson or csv");
  if (format != "json") return Export(context, request, format, response);
  const Page page = PageOf(request);
  const auto version = VersionParameter(request);
  std::vector<Measurement> found = context.store.database.Read([&](Connection& connection) {
    FindSite(connection, request.matches[1]);
    return ListMeasurements(connection, request.matches[1], version, WithOneMore(page));
  });
  SendPage(response, page, std::move(found),
           [](const Measurement& measurement) { return ToJson(measurement); });
}

Measurement ParseMeasurement(const httplib::ContentReader& body) {
  const Json json = ReadObject(body, {"kind", "title", "version", "points"});
  Measurement measurement;
  const auto kind = MeasurementKindFromText(TextIn(json, "kind").value_or(""));
  Require(kind.has_value(), ErrorCode::kInvalidInput,
          "\"kind\" is one of distance, area, height, slope and section");
  measurement.kind = *kind;
  measurement.title = TextIn(json, "title").value_or("");
  measurement.version = IntegerIn(json, "version").value_or(0);
  const Json points = json.value("points", Json());
  Require(points.is_array(), ErrorCode::kInvalidInput, "\"points\" is a list of points [x, y, z]");
  for (const Json& point : points) measurement.points.push_back(PointOf(point));
  return measurement;
}

}  // namespace

void AddMeasurementRoutes(Router& routes, RouteContext& context) {
  using Request = httplib::Request;
  using Response = httplib::Response;
  routes.On(
      "GET /api/v1/sites/{site}/measurements",
      [&context](const Request& request, Response& response) { List(context, request, response); });
  routes.On(
      "POST /api/v1/sites/{site}/measurements",
      [&context](const Request& request, Response& response, const httplib::ContentReader& body) {
        Measurement measurement = ParseMeasurement(body);
        measurement.site = request.matches[1];
        measurement = SaveMeasurement(context.store, std::move(measurement), CurrentCaller().name);
        response.set_header(
            "Location", "/api/v1/sites/" + measurement.site + "/measurements/" + measurement.id);
        SendJson(response, 201, ToJson(measurement));
      });
  routes.On("GET /api/v1/sites/{site}/measurements/{measurement}",
            [&context](const Request& request, Response& response) {
              SendJson(response, 200,
                       ToJson(context.store.database.Read([&](Connection& connection) {
                         return FindMeasurement(connection, request.matches[1], request.matches[2]);
                       })));
            });
  routes.On("DELETE /api/v1/sites/{site}/measurements/{measurement}",
            [&context](const Request& request, Response& response) {
              RemoveMeasurement(context.store, request.matches[1], request.matches[2]);
              response.status = 204;
            });
}

}  // namespace parkade
