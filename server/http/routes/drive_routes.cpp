#include "server/http/json_response.h"
#include "server/http/routes/routes.h"
#include "server/store/receive_upload.h"
#include "server/store/tables/drive_table.h"
#include "server/store/tables/map_table.h"

namespace parkade {

void AddDriveRoutes(httplib::Server& http, RouteContext& context) {
  http.Get("/api/v1/drives", [&context](const httplib::Request& request,
                                        httplib::Response& response) {
    const Page page = PageOf(request);
    const auto site = QueryParameter(request, "site");
    std::vector<Drive> drives = context.store.database.Read(
        [&](Connection& connection) { return ListDrives(connection, WithOneMore(page), site); });
    SendPage(response, page, std::move(drives), [](const Drive& drive) { return ToJson(drive); });
  });

  http.Get("/api/v1/drives/" + kIdPattern, [&context](const httplib::Request& request,
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

  http.Delete("/api/v1/drives/" + kIdPattern,
              [&context](const httplib::Request& request, httplib::Response& response) {
                const std::string id = request.matches[1];
                DeleteDrive(context.store, id);
                context.events.Publish("drive", id);
                response.status = 204;
              });
}

}  // namespace parkade
