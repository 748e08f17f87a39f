#include <vector>

#include "core/error.h"
#include "core/log.h"
#include "server/http/access/rights.h"
#include "server/http/file_response.h"
#include "server/http/json_response.h"
#include "server/http/problem.h"
#include "server/http/routes/map_request.h"
#include "server/http/routes/routes.h"
#include "server/store/care/stored_files.h"
#include "server/store/job_queue.h"
#include "server/store/tables/check_table.h"
#include "server/store/tables/map_table.h"
#include "server/store/tables/site_table.h"

namespace parkade {
namespace {

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

void CheckPins(RouteContext& context, const std::string& site, const MapReview& review) {
  if (!review.pins || review.pins->empty() || !context.options.check_pins) return;
  const MapVersion from = context.store.database.Read(
      [&](Connection& connection) { return FindMapRow(connection, site, *review.from_version); });
  RequireFiles(from);
  context.options.check_pins(*review.pins, context.store.directory.MapFolder(from.id));
}

void BuildMap(RouteContext& context, const std::string& site, const MapRequest& request,
              httplib::Response& response) {
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
              BuildMap(context, request.matches[1], ReadMapRequest(body), response);
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
