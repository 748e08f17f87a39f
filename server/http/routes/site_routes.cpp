#include "server/http/json_response.h"
#include "server/http/routes/routes.h"
#include "server/store/tables/site_table.h"

namespace parkade {

void AddSiteRoutes(httplib::Server& http, RouteContext& context) {
  http.Get(
      "/api/v1/sites", [&context](const httplib::Request& request, httplib::Response& response) {
        const Page page = PageOf(request);
        std::vector<Site> sites = context.store.database.Read(
            [&](Connection& connection) { return ListSites(connection, WithOneMore(page)); });
        SendPage(response, page, std::move(sites), [](const Site& site) { return ToJson(site); });
      });

  http.Get("/api/v1/sites/" + kNamePattern,
           [&context](const httplib::Request& request, httplib::Response& response) {
             const Site site = context.store.database.Read(
                 [&](Connection& connection) { return FindSite(connection, request.matches[1]); });
             SendJson(response, 200, ToJson(site));
           });
}

}  // namespace parkade
