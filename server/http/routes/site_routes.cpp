#include "server/http/json_response.h"
#include "server/http/routes/routes.h"
#include "server/store/tables/site_table.h"

namespace parkade {

void AddSiteRoutes(Router& routes, RouteContext& context) {
  routes.On("GET /api/v1/sites", [&context](const httplib::Request& request,
                                            httplib::Response& response) {
    const Page page = PageOf(request);
    std::vector<Site> sites = context.store.database.Read(
        [&](Connection& connection) { return ListSites(connection, WithOneMore(page)); });
    SendPage(response, page, std::move(sites), [](const Site& site) { return ToJson(site); });
  });

  routes.On("GET /api/v1/sites/{site}",
            [&context](const httplib::Request& request, httplib::Response& response) {
              const Site site = context.store.database.Read(
                  [&](Connection& connection) { return FindSite(connection, request.matches[1]); });
              SendJson(response, 200, ToJson(site));
            });
}

}  // namespace parkade
