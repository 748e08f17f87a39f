#include <map>
#include <string>

#include "core/error.h"
#include "core/files/file.h"
#include "server/http/file_response.h"
#include "server/http/json_response.h"
#include "server/http/problem.h"
#include "server/http/routes/routes.h"
#include "server/jobs/map_comparer.h"
#include "server/store/tables/map_table.h"
#include "server/store/tables/site_table.h"

namespace parkade {
namespace {

constexpr const char* kImmutable = "private, max-age=31536000, immutable";

/// The file of a comparison that `format` names; JSON is made here.
const std::map<std::string, std::string> kFiles = {{"json", "changes.json"},
                                                   {"geojson", "changes.geojson"},
                                                   {"png", "changes.png"},
                                                   {"pgw", "changes.pgw"}};

std::int64_t ParseVersion(const std::string& text) {
  const bool is_number = !text.empty() && text.size() <= 9 &&
                         text.find_first_not_of("0123456789") == std::string::npos;
  Require(is_number, ErrorCode::kInvalidInput,
          "a version is a number or 'latest', not '" + text + "'");
  return std::stoll(text);
}

std::string AddressOf(const std::string& site, std::int64_t from, std::int64_t to,
                      const std::string& format) {
  return "/api/v1/sites/" + site + "/compare?from=" + std::to_string(from) +
         "&to=" + std::to_string(to) + (format == "json" ? "" : "&format=" + format);
}

/// The worker's result, with what only the service knows.
std::string Complete(const std::string& found, const MapVersion& from, const MapVersion& to) {
  Json json = {{"site", from.site}, {"from", from.version}, {"to", to.version}};
  json.update(Json::parse(found));
  for (const auto& [format, file] : kFiles)
    if (format != "json")
      json["urls"][format] = AddressOf(from.site, from.version, to.version, format);
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

void SendComparison(RouteContext& context, const httplib::Request& request,
                    httplib::Response& response) {
  const std::string site = request.matches[1];
  const std::string from_text = QueryParameter(request, "from").value_or("");
  const std::string to_text = QueryParameter(request, "to").value_or("latest");
  const std::string format = QueryParameter(request, "format").value_or("json");
  Require(!from_text.empty(), ErrorCode::kInvalidInput,
          "say which version to compare from: ?from=1&to=2");
  Require(kFiles.contains(format), ErrorCode::kInvalidInput,
          "a comparison comes as json, geojson, png or pgw");
  const auto [from, to] = context.store.database.Read([&](Connection& connection) {
    FindSite(connection, site);
    const auto find = [&](const std::string& text) {
      MapVersion map =
          FindMapRow(connection, site,
                     text == "latest" ? LatestMapVersion(connection, site) : ParseVersion(text));
      RequireFiles(map);
      return map;
    };
    return std::pair(find(from_text), find(to_text));
  });
  RequireVersion(from.version);
  RequireVersion(to.version);
  if (from_text == "latest" ||
      to_text == "latest") {  // it changes; the address it leads to does not
    response.set_header("Cache-Control", "no-cache");
    response.set_redirect(AddressOf(site, from.version, to.version, format), 307);
    return;
  }
  const std::string etag = '"' + from.id + '-' + to.id + '-' + format + '"';
  if (SendNotModified(request, response, etag, kImmutable)) return;
  const std::optional<std::filesystem::path> folder = context.comparer.Compare(from.id, to.id);
  if (!folder)
    throw HttpError({503, "busy", "too many versions are being compared: try again in a minute"});
  const std::string& name = kFiles.at(format);
  const std::string content = ReadFile(*folder / name);
  response.status = 200;
  response.set_header("ETag", etag);
  response.set_header("Cache-Control", kImmutable);
  response.set_content(format == "json" ? Complete(content, from, to) : content,
                       ContentTypeOf(name));
}

}  // namespace

void AddCompareRoute(Router& routes, RouteContext& context) {
  routes.On("GET /api/v1/sites/{site}/compare",
            [&context](const httplib::Request& request, httplib::Response& response) {
              SendComparison(context, request, response);
            });
}

}  // namespace parkade
