#include <poll.h>

#include <array>
#include <charconv>
#include <cmath>
#include <memory>

#include "core/error.h"
#include "server/http/current_socket.h"
#include "server/http/json_response.h"
#include "server/http/problem.h"
#include "server/http/routes/drive_map.h"
#include "server/http/routes/look_record.h"
#include "server/http/routes/routes.h"
#include "server/store/tables/drive_table.h"
#include "server/store/tables/rig_table.h"

namespace parkade {
namespace {

constexpr double kNearby = 1;  // [s] from the time that is asked for to the picture's
constexpr int kMinWidth = 16, kMaxWidth = 8192;
constexpr int kUsualViews = 8, kMaxViews = 100;

// Pictures show people and number plates: they stay in no cache that others use.
constexpr const char* kPersonal = "private, no-store";

int IntegerParameter(const httplib::Request& request, const char* name, int least, int greatest,
                     int otherwise) {
  const auto text = QueryParameter(request, name);
  if (!text) return otherwise;
  int number = 0;
  const auto [end, error] = std::from_chars(text->data(), text->data() + text->size(), number);
  Require(error == std::errc{} && end == text->data() + text->size() && number >= least &&
              number <= greatest,
          ErrorCode::kInvalidInput,
          std::string(name) + " is a number from " + std::to_string(least) + " to " +
              std::to_string(greatest));
  return number;
}

/// "X,Y,Z" [m] in site.
std::array<double, 3> PointOf(const std::string& text) {
  std::array<double, 3> point{};
  const char *at = text.data(), *end = text.data() + text.size();
  for (size_t i = 0; i < 3; ++i) {
    const auto [after, error] = std::from_chars(at, end, point[i]);
    const bool is_last = i == 2;
    const bool goes_on = is_last ? after == end : after != end && *after == ',';
    Require(error == std::errc{} && goes_on && std::isfinite(point[i]), ErrorCode::kInvalidInput,
            "a point is X,Y,Z in meters of the site, not '" + text + "'");
    at = after + 1;
  }
  return point;
}

PictureLog LogOf(RouteContext& context, const Drive& drive) {
  Require(context.pictures != nullptr, ErrorCode::kNotFound, "the service reads no pictures");
  RequireLog(drive);
  PictureLog log{drive.id, context.store.directory.LogFile(drive.sha256), {}};
  if (drive.rig)
    if (const auto rig = context.store.database.Read(
            [&](Connection& connection) { return FindRig(connection, *drive.rig); }))
      log.rig = rig->id;
  return log;
}

/// Whether the client of this thread's request is still there.
PictureDesk::IsWanted ClientWaits() {
  return [socket = CurrentSocket()] {
    pollfd client{socket, POLLRDHUP, 0};
    return socket < 0 || ::poll(&client, 1, 0) == 0;
  };
}

/// What the desk says, in words of HTTP: a log that cannot be read has no pictures.
template <typename Function>
auto AskDesk(httplib::Response& response, const Function& ask) {
  try {
    return ask();
  } catch (const Error& error) {
    if (error.code() == ErrorCode::kInvalidInput) throw Error(ErrorCode::kNotFound, error.what());
    if (error.code() != ErrorCode::kConflict) throw;
    response.set_header("Retry-After", "2");
    throw HttpError({503, "busy", error.what()});
  }
}

void SendPicture(RouteContext& context, LookRecord& looks, const httplib::Request& request,
                 httplib::Response& response) {
  const std::string id = request.matches[1], camera = request.matches[2];
  const auto time_text = QueryParameter(request, "time");
  Require(time_text.has_value(), ErrorCode::kInvalidInput,
          "say at which time, in seconds of the drive's clock: ?time=T");
  const Timestamp time = ParseSeconds(*time_text);
  const int width = IntegerParameter(request, "width", kMinWidth, kMaxWidth, 0);
  const PictureLog log = LogOf(context, context.store.database.Read([&](Connection& connection) {
    return FindDrive(connection, id);
  }));
  const ServedPicture picture = AskDesk(response, [&] {
    const auto times = context.pictures->TimesOf(log, ClientWaits());
    const size_t number = times->NumberOf(camera);
    const auto nearest = NearestTime(times->cameras[number].times, time, kNearby);
    Require(nearest.has_value(), ErrorCode::kNotFound,
            "camera '" + camera + "' has no image within a second of " + *time_text);
    return context.pictures->Read(log, number, *nearest, width, ClientWaits());
  });
  looks.Note(context.store.database, id);
  response.set_header("Cache-Control", kPersonal);
  response.set_header("Picture-Time", ToDecimalSeconds(picture.time));
  response.set_header("Picture-Size",
                      std::to_string(picture.width) + "x" + std::to_string(picture.height));
  response.set_header("Picture-Full-Size", std::to_string(picture.full_width) + "x" +
                                               std::to_string(picture.full_height));
  response.status = 200;
  response.set_content(picture.jpeg, "image/jpeg");
}

void SendViews(RouteContext& context, const httplib::Request& request,
               httplib::Response& response) {
  const auto point = QueryParameter(request, "point");
  Require(point.has_value(), ErrorCode::kInvalidInput,
          "say which point of the site the images are to show: ?point=X,Y,Z");
  const std::array<double, 3> in_site = PointOf(*point);
  const int limit = IntegerParameter(request, "limit", 1, kMaxViews, kUsualViews);
  const DriveInMap found =
      FindDriveInMap(context.store, request.matches[1], QueryParameter(request, "version"));
  const PictureLog log = LogOf(context, found.drive);
  Json views = AskDesk(response, [&] {
    return context.pictures->FindViews(
        log,
        {{"map", context.store.directory.MapFolder(found.map.id).string()},
         {"drive", found.drive.name},
         {"point", in_site},
         {"limit", limit}},
        ClientWaits());
  });
  for (Json& view : views)
    view["url"] = "/api/v1/drives/" + found.drive.id + "/images/" +
                  view.at("camera").get<std::string>() +
                  "?time=" + view.at("time").get<std::string>();
  response.set_header("Cache-Control", kPersonal);
  SendJson(response, 200,
           {{"drive", found.drive.id},
            {"site", found.map.site},
            {"version", found.map.version},
            {"views", std::move(views)}});
}

}  // namespace

void AddPictureRoutes(Router& routes, RouteContext& context) {
  routes.On("GET /api/v1/drives/{drive}/images",
            [&context](const httplib::Request& request, httplib::Response& response) {
              SendViews(context, request, response);
            });

  routes.On("GET /api/v1/drives/{drive}/images/{camera}",
            [&context, looks = std::make_shared<LookRecord>()](const httplib::Request& request,
                                                               httplib::Response& response) {
              SendPicture(context, *looks, request, response);
            });
}

}  // namespace parkade
