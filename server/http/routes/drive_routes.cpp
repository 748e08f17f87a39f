#include "core/error.h"
#include "server/http/json_response.h"
#include "server/http/routes/routes.h"
#include "server/store/receive_upload.h"
#include "server/store/tables/drive_table.h"
#include "server/store/tables/map_table.h"

namespace parkade {
namespace {

/// A drive that was never looked at, by an older program say, is now; come back for the answer.
void SendInspection(RouteContext& context, const std::string& id, httplib::Response& response) {
  const auto [drive, json] = context.store.database.Read([&](Connection& connection) {
    return std::pair(FindDrive(connection, id), InspectionOf(connection, id));
  });
  response.set_header("Cache-Control", "no-store");
  if (json) {
    SendJson(response, 200, Json::parse(*json));
    return;
  }
  const bool is_over = drive.inspection_state && *drive.inspection_state != kWaiting;
  Require(!is_over && context.inspector != nullptr, ErrorCode::kNotFound,
          drive.error.value_or("the log of drive '" + id + "' could not be inspected"));
  RequireLog(drive);
  if (!drive.inspection_state) {
    context.store.database.Write([&](Connection& connection) {
      SetDriveInspection(connection, id, {.state = kWaiting, .json = {}, .error = {}});
    });
    context.inspector->Wake();
  }
  response.set_header("Retry-After", "1");
  SendJson(response, 202, {{"state", kWaiting}});
}

}  // namespace

void AddDriveRoutes(Router& routes, RouteContext& context) {
  routes.On("GET /api/v1/drives", [&context](const httplib::Request& request,
                                             httplib::Response& response) {
    const Page page = PageOf(request);
    const auto site = QueryParameter(request, "site");
    std::vector<Drive> drives = context.store.database.Read([&](Connection& connection) {
      return ListDrives(connection, WithOneMore(page), site, CurrentCaller().sites);
    });
    SendPage(response, page, std::move(drives), [](const Drive& drive) { return ToJson(drive); });
  });

  routes.On("GET /api/v1/drives/{drive}", [&context](const httplib::Request& request,
                                                     httplib::Response& response) {
    const Json json = context.store.database.Read([&](Connection& connection) {
      const Drive drive = FindDrive(connection, request.matches[1]);
      Json found = ToJson(drive);
      const MapVersion map =
          drive.map_version ? FindMap(connection, drive.site, *drive.map_version) : MapVersion{};
      AddTrajectories(drive, map, found);
      return found;
    });
    SendJson(response, 200, json);
  });

  routes.On("GET /api/v1/drives/{drive}/inspect",
            [&context](const httplib::Request& request, httplib::Response& response) {
              SendInspection(context, request.matches[1], response);
            });

  routes.On("DELETE /api/v1/drives/{drive}",
            [&context](const httplib::Request& request, httplib::Response& response) {
              const std::string id = request.matches[1];
              DeleteDrive(context.store, id);
              context.events.Publish("drive", id);
              response.status = 204;
            });
}

}  // namespace parkade
