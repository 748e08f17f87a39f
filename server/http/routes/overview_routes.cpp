#include "core/error.h"
#include "server/http/json_response.h"
#include "server/http/routes/review_view.h"
#include "server/http/routes/routes.h"
#include "server/store/tables/map_table.h"

namespace parkade {
namespace {

std::optional<bool> FlagParameter(const httplib::Request& request, const char* name) {
  const auto text = QueryParameter(request, name);
  if (!text) return std::nullopt;
  Require(*text == "true" || *text == "false", ErrorCode::kInvalidInput,
          std::string("'") + name + "' is true or false");
  return *text == "true";
}

}  // namespace

void AddOverviewRoutes(Router& routes, RouteContext& context) {
  routes.On(
      "GET /api/v1/maps", [&context](const httplib::Request& request, httplib::Response& response) {
        const Page page = PageOf(request);
        const std::vector<ReviewState> states = ReviewStatesOf(request);
        std::vector<MapVersion> maps = context.store.database.Read([&](Connection& connection) {
          return ListAllMaps(connection, WithOneMore(page), CurrentCaller().sites, states);
        });
        SendPage(response, page, std::move(maps),
                 [](const MapVersion& map) { return ToJson(map, /*with_files=*/false); });
      });

  routes.On("GET /api/v1/comments", [&context](const httplib::Request& request,
                                               httplib::Response& response) {
    const Page page = PageOf(request);
    const ThreadFilter filter{CurrentCaller().sites, QueryParameter(request, "site"),
                              FlagParameter(request, "resolved"), ReviewStatesOf(request)};
    std::vector<CommentThread> threads = context.store.database.Read(
        [&](Connection& connection) { return ListThreads(connection, WithOneMore(page), filter); });
    SendPage(response, page, std::move(threads),
             [](const CommentThread& thread) { return ToJson(thread); });
  });
}

}  // namespace parkade
