#include "server/http/json_response.h"
#include "server/http/routes/routes.h"
#include "server/store/tables/site_table.h"

namespace parkade {
namespace {

/// Without the versions that the caller's link does not lead to.
Site AsSeen(Site site) {
  const auto only = CurrentCaller().version;
  if (only) std::erase_if(site.versions, [&](std::int64_t version) { return version != *only; });
  return site;
}

}  // namespace

void AddSiteRoutes(Router& routes, RouteContext& context) {
  routes.On("GET /api/v1/sites",
            [&context](const httplib::Request& request, httplib::Response& response) {
              const Page page = PageOf(request);
              std::vector<Site> sites = context.store.database.Read([&](Connection& connection) {
                return ListSites(connection, WithOneMore(page), CurrentCaller().sites);
              });
              SendPage(response, page, std::move(sites),
                       [](const Site& site) { return ToJson(AsSeen(site)); });
            });

  routes.On("GET /api/v1/sites/{site}",
            [&context](const httplib::Request& request, httplib::Response& response) {
              const Site site = context.store.database.Read(
                  [&](Connection& connection) { return FindSite(connection, request.matches[1]); });
              SendJson(response, 200, ToJson(AsSeen(site)));
            });
}

}  // namespace parkade
