#include <algorithm>
#include <charconv>
#include <limits>

#include "core/error.h"
#include "server/http/json_response.h"
#include "server/http/routes/drive_map.h"
#include "server/http/routes/routes.h"
#include "server/http/routes/thin_series.h"

namespace parkade {
namespace {

constexpr int kMinPoints = 2, kMaxPoints = 20000, kUsualPoints = 1000;

int PointsOf(const httplib::Request& request) {
  const auto text = QueryParameter(request, "points");
  if (!text) return kUsualPoints;
  int points = 0;
  const auto [end, error] = std::from_chars(text->data(), text->data() + text->size(), points);
  Require(error == std::errc{} && end == text->data() + text->size() && points >= kMinPoints &&
              points <= kMaxPoints,
          ErrorCode::kInvalidInput,
          "points is a number from " + std::to_string(kMinPoints) + " to " +
              std::to_string(kMaxPoints));
  return points;
}

/// The answer's beginning: of which drive and version it is.
Json HeadOf(const DriveInMap& found) {
  return {{"drive", found.drive.id}, {"site", found.map.site}, {"version", found.map.version}};
}

Timestamp TimeParameter(const httplib::Request& request, const char* name, Timestamp otherwise) {
  const auto text = QueryParameter(request, name);
  return text ? ParseSeconds(*text) : otherwise;
}

/// The stretch of the drive's clock between the parameters `from` and `to`.
TimeSpan RangeOf(const httplib::Request& request) {
  const TimeSpan range{TimeParameter(request, "from", {0}),
                       TimeParameter(request, "to", {std::numeric_limits<std::int64_t>::max()})};
  Require(range.begin <= range.end, ErrorCode::kInvalidInput, "'from' lies after 'to'");
  return range;
}

void SendPlots(RouteContext& context, const httplib::Request& request,
               httplib::Response& response) {
  const int points = PointsOf(request);
  const TimeSpan range = RangeOf(request);
  const DriveInMap found =
      FindDriveInMap(context.store, request.matches[1], QueryParameter(request, "version"));
  Json json = HeadOf(found);
  json.update(ReadJsonOfDrive(context.store, found, "diagnostics.json"));
  const Timestamp start = ParseSeconds(json.at("start"));
  for (Json& series : json.at("series")) {
    const TimeSeries all{series.at("times").get<std::vector<double>>(),
                         series.at("values").get<std::vector<double>>()};
    const ThinnedRange thin = ThinRange(all, range.begin - start, range.end - start, points);
    series["count"] = thin.count;
    series["times"] = thin.series.times;
    series["values"] = thin.series.values;
  }
  SendJson(response, 200, json);
}

void SendKeyframes(RouteContext& context, const httplib::Request& request,
                   httplib::Response& response) {
  const auto points = static_cast<size_t>(PointsOf(request));
  const TimeSpan range = RangeOf(request);
  const DriveInMap found =
      FindDriveInMap(context.store, request.matches[1], QueryParameter(request, "version"));
  Json json = HeadOf(found);
  json.update(ReadJsonOfDrive(context.store, found, "keyframes.json"));
  Json inside = Json::array(), kept = Json::array();
  for (Json& keyframe : json.at("keyframes")) {
    if (range.Contains(ParseSeconds(keyframe.at("time")))) inside.push_back(std::move(keyframe));
  }
  const size_t count = inside.size(), num_kept = std::min(count, points);
  for (size_t i = 0; i < num_kept; ++i) kept.push_back(std::move(inside[i * count / num_kept]));
  json["count"] = count;
  json["keyframes"] = std::move(kept);
  SendJson(response, 200, json);
}

}  // namespace

void AddPlotRoutes(Router& routes, RouteContext& context) {
  routes.On("GET /api/v1/drives/{drive}/plots",
            [&context](const httplib::Request& request, httplib::Response& response) {
              SendPlots(context, request, response);
            });

  routes.On("GET /api/v1/drives/{drive}/keyframes",
            [&context](const httplib::Request& request, httplib::Response& response) {
              SendKeyframes(context, request, response);
            });
}

}  // namespace parkade
