#include <algorithm>

#include "core/error.h"
#include "core/log.h"
#include "server/http/access/rights.h"
#include "server/http/file_response.h"
#include "server/http/json_response.h"
#include "server/http/problem.h"
#include "server/http/routes/routes.h"
#include "server/store/care/stored_files.h"
#include "server/store/job_queue.h"
#include "server/store/tables/check_table.h"
#include "server/store/tables/map_table.h"
#include "server/store/tables/site_table.h"

namespace parkade {
namespace {

constexpr std::size_t kMaxPins = 1000;
constexpr const char* kImmutable = "private, max-age=31536000, immutable";

/// 410 where the retention deleted the version's files.
void RequireNotGone(const MapVersion& map) {
  try {
    RequireFiles(map);
  } catch (const Error& error) {
    throw HttpError({410, "deleted", error.what()});
  }
}

void SendManifest(RouteContext& context, const httplib::Request& request,
                  httplib::Response& response) {
  const MapVersion map = context.store.database.Read([&](Connection& connection) {
    return FindMap(connection, request.matches[1], std::stoll(request.matches[2]));
  });
  RequireNotGone(map);
  const std::string etag = '"' + map.sha256 + '"';
  if (SendNotModified(request, response, etag, kImmutable)) return;
  response.status = 200;
  response.set_header("ETag", etag);
  response.set_header("Cache-Control", kImmutable);
  response.set_content(
      ToJson(map, /*with_files=*/true).dump(-1, ' ', false, Json::error_handler_t::replace) + "\n",
      "application/json");
}

/// The pictures at both ends of loops come from the cameras as they are; all others are made of
/// many.
bool IsCameraPicture(const std::string& name) {
  return name.find("/loops/") != std::string::npos && name.ends_with(".jpg");
}

/// A note that cannot be taken, on a full disk say, is taken by the next reader.
void NoteDamage(RouteContext& context, const std::string& path) {
  try {
    RecordFileCheck(context.store, path, "has changed on the disk");
  } catch (const Error& error) {
    LogError(std::string("damage not noted error=") + error.what());
  }
}

void SendMapFile(RouteContext& context, const httplib::Request& request,
                 httplib::Response& response) {
  const std::string name = request.matches[3];
  if (IsCameraPicture(name) && !CurrentCaller().may_see_pictures)
    throw HttpError({403, "forbidden", NeedOf(Right::kPictures)});
  const PublishedFile published = context.store.database.Read([&](Connection& connection) {
    const std::int64_t version = std::stoll(request.matches[2]);
    RequireNotGone(FindMapRow(connection, request.matches[1], version));
    return FindMapFile(connection, request.matches[1], version, name);
  });
  const std::string path = "maps/" + published.map_id + "/" + name;
  const bool was_damaged = context.store.database.Read(
      [&](Connection& connection) { return DamageOf(connection, path).has_value(); });
  // What an older program published can be checked by the scrubber only.
  if (was_damaged && published.file.pieces.empty())
    throw HttpError({500, "damaged", "the stored file '" + name + "' is damaged or missing"});
  // Only a name that the manifest holds becomes a path.
  ServedFile file;
  file.path = context.store.directory.MapFolder(published.map_id) / published.file.name;
  file.bytes = published.file.bytes;
  file.sha256 = published.file.sha256;
  file.content_type = ContentTypeOf(name);
  file.cache_control = kImmutable;
  file.pieces = published.file.pieces;
  file.on_damage = [&context, path] { NoteDamage(context, path); };
  if (!was_damaged && context.accel.IsFor(request, file))
    context.accel.Send(request, response, file, path);
  else
    SendFile(request, response, file);
}

/// From `latest` and `approved`; `rest` of the address stays.
void Redirect(RouteContext& context, const httplib::Request& request, const std::string& rest,
              httplib::Response& response) {
  const std::string site = request.matches[1];
  const std::int64_t version = context.store.database.Read([&](Connection& connection) {
    FindSite(connection, site);
    const auto only = CurrentCaller().version;
    if (only) return *only;
    return request.matches[2] == "approved" ? ApprovedMapVersion(connection, site)
                                            : LatestMapVersion(connection, site);
  });
  response.set_header("Cache-Control", "no-cache");
  response.set_redirect(MapAddress(site, version) + rest, 307);
}

/// The members that the body of a request to build a map may hold.
struct MapRequest {
  std::vector<std::string> drives;
  MapReview review;
};

std::vector<std::string> TextsOf(const std::string& key, const Json& value) {
  Require(value.is_array(), ErrorCode::kInvalidInput, '"' + key + "\" is a list");
  std::vector<std::string> texts;
  for (const Json& text : value) {
    // A word that begins with a dash would pass for an option of the worker's command line.
    Require(text.is_string() && !text.get<std::string>().empty() &&
                text.get<std::string>().front() != '-',
            ErrorCode::kInvalidInput, '"' + key + "\" is a list of ids");
    texts.push_back(text);
  }
  return texts;
}

std::string NumberIn(const Json& object, const char* key) {
  const auto found = object.find(key);
  Require(found != object.end() && found->is_number(), ErrorCode::kInvalidInput,
          std::string("a pin's \"") + key + "\" is a number");
  return found->dump();
}

/// {"point": [X, Y, Z], "latitude": LAT, "longitude": LON, "height": HEIGHT, "drive": NAME} as the
/// worker takes it.
std::string PinOf(const Json& pin) {
  Require(pin.is_object(), ErrorCode::kInvalidInput, "a pin is an object");
  for (const auto& [key, value] : pin.items())
    Require(key == "point" || key == "latitude" || key == "longitude" || key == "height" ||
                key == "drive",
            ErrorCode::kInvalidInput,
            "a pin knows \"point\", \"latitude\", \"longitude\", \"height\" and \"drive\"");
  const auto point = pin.find("point");
  Require(point != pin.end() && point->is_array() && point->size() == 3 &&
              std::all_of(point->begin(), point->end(),
                          [](const Json& number) { return number.is_number(); }),
          ErrorCode::kInvalidInput, "a pin's \"point\" is a list of three numbers");
  std::string text;
  if (const auto drive = pin.find("drive"); drive != pin.end()) {
    Require(drive->is_string() && !drive->get<std::string>().empty(), ErrorCode::kInvalidInput,
            "a pin's \"drive\" is the name of one");
    text = drive->get<std::string>() + ":";
  }
  text += (*point)[0].dump() + "," + (*point)[1].dump() + "," + (*point)[2].dump() + "=";
  text += NumberIn(pin, "latitude") + "," + NumberIn(pin, "longitude");
  if (pin.contains("height") && !pin.at("height").is_null()) text += "," + NumberIn(pin, "height");
  return text;
}

std::vector<std::string> PinsOf(const Json& value) {
  Require(value.is_array() && value.size() <= kMaxPins, ErrorCode::kInvalidInput,
          "\"pins\" is a list of at most " + std::to_string(kMaxPins) + " pins");
  std::vector<std::string> pins;
  for (const Json& pin : value) pins.push_back(PinOf(pin));
  return pins;
}

MapRequest ParseMapRequest(const std::string& body) {
  MapRequest request;
  if (body.empty()) return request;
  const Json json = Json::parse(body, nullptr, /*allow_exceptions=*/false);
  Require(json.is_object(), ErrorCode::kInvalidInput,
          "the body is a JSON object: {\"drives\": [\"ID\", ...]}");
  for (const auto& [key, value] : json.items()) {
    if (key == "drives") {
      request.drives = TextsOf(key, value);
    } else if (key == "from") {
      Require(value.is_number_integer(), ErrorCode::kInvalidInput,
              "\"from\" is the number of a version");
      request.review.from_version = value.get<std::int64_t>();
    } else if (key == "reject_loops") {
      request.review.rejected_loops = TextsOf(key, value);
    } else if (key == "force_loops") {
      request.review.forced_loops = TextsOf(key, value);
    } else if (key == "pins") {
      request.review.pins = PinsOf(value);
    } else {
      throw Error(
          ErrorCode::kInvalidInput,
          "the body knows \"drives\", \"from\", \"reject_loops\", \"force_loops\" and \"pins\"");
    }
  }
  const bool decides = !request.review.rejected_loops.empty() ||
                       !request.review.forced_loops.empty() || request.review.pins;
  Require(!decides || request.review.from_version, ErrorCode::kInvalidInput,
          "loops and pins are those of a version: name it in \"from\"");
  return request;
}

void CheckPins(RouteContext& context, const std::string& site, const MapReview& review) {
  if (!review.pins || review.pins->empty() || !context.options.check_pins) return;
  const MapVersion from = context.store.database.Read(
      [&](Connection& connection) { return FindMapRow(connection, site, *review.from_version); });
  RequireFiles(from);
  context.options.check_pins(*review.pins, context.store.directory.MapFolder(from.id));
}

void BuildMap(RouteContext& context, const std::string& site, const std::string& body,
              httplib::Response& response) {
  const MapRequest request = ParseMapRequest(body);
  CheckPins(context, site, request.review);
  const Job job =
      QueueMap(context.store, site, request.drives, context.options.merge_drives, request.review);
  context.events.Publish("job", job.id);
  for (const std::string& drive : job.drives) context.events.Publish("drive", drive);
  context.jobs.Wake();
  response.set_header("Location", "/api/v1/jobs/" + job.id);
  SendJson(response, 202, ToJson(job, std::nullopt));
}

}  // namespace

void AddMapRoutes(Router& routes, RouteContext& context) {
  routes.On("GET /api/v1/sites/{site}/maps", [&context](const httplib::Request& request,
                                                        httplib::Response& response) {
    const std::string site = request.matches[1];
    const Page page = PageOf(request);
    std::vector<MapVersion> versions = context.store.database.Read([&](Connection& connection) {
      FindSite(connection, site);
      return ListMaps(connection, site, WithOneMore(page));
    });
    if (const auto only = CurrentCaller().version)
      std::erase_if(versions, [&](const MapVersion& map) { return map.version != *only; });
    SendPage(response, page, std::move(versions),
             [](const MapVersion& map) { return ToJson(map, /*with_files=*/false); });
  });

  routes.On("POST /api/v1/sites/{site}/maps",
            [&context](const httplib::Request& request, httplib::Response& response,
                       const httplib::ContentReader& body) {
              BuildMap(context, request.matches[1], ReadBody(body), response);
            });

  routes.On("GET /api/v1/sites/{site}/maps/{version}",
            [&context](const httplib::Request& request, httplib::Response& response) {
              SendManifest(context, request, response);
            });
  routes.On("GET /api/v1/sites/{site}/maps/{version}/{file}",
            [&context](const httplib::Request& request, httplib::Response& response) {
              SendMapFile(context, request, response);
            });
  routes.On("GET /api/v1/sites/{site}/maps/{alias}",
            [&context](const httplib::Request& request, httplib::Response& response) {
              Redirect(context, request, "", response);
            });
  routes.On("GET /api/v1/sites/{site}/maps/{alias}/{file}",
            [&context](const httplib::Request& request, httplib::Response& response) {
              Redirect(context, request, "/" + request.matches[3].str(), response);
            });
}

}  // namespace parkade
