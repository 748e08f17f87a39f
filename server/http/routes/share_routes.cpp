#include "core/error.h"
#include "server/http/json_response.h"
#include "server/http/routes/json_body.h"
#include "server/http/routes/routes.h"
#include "server/store/access/access_rules.h"
#include "server/store/access/shares.h"

namespace parkade {
namespace {

constexpr int kDaysUnlessSaid = 30;

Json ToJson(const Share& share) {
  return {{"id", share.id},
          {"name", share.name},
          {"site", share.site},
          {"version", OrNull(share.version)},
          {"created_by", share.created_by},
          {"created_at", share.created_at},
          {"expires_at", share.expires_at},
          {"revoked_at", OrNull(share.revoked_at)}};
}

Share WantedIn(const Json& object) {
  Share share;
  share.name = TextIn(object, "name").value_or("");
  share.site = TextIn(object, "site").value_or("");
  Require(!share.site.empty(), ErrorCode::kInvalidInput, "\"site\" is missing");
  share.version = IntegerIn(object, "version");
  share.expires_at = EndAfterDays(IntegerIn(object, "days").value_or(kDaysUnlessSaid));
  return share;
}

}  // namespace

void AddShareRoutes(Router& routes, RouteContext& context) {
  routes.On("GET /api/v1/shares", [&context](const httplib::Request& request,
                                             httplib::Response& response) {
    const Page page = PageOf(request);
    std::vector<Share> shares = context.store.database.Read([&](Connection& connection) {
      return ListShares(connection, WithOneMore(page), CurrentCaller().sites);
    });
    SendPage(response, page, std::move(shares), [](const Share& share) { return ToJson(share); });
  });

  routes.On("POST /api/v1/shares", [&context](const httplib::Request&, httplib::Response& response,
                                              const httplib::ContentReader& body) {
    Require(!context.gate.IsOpen(), ErrorCode::kConflict,
            "this service has no tokens: whoever reaches it sees all maps without a link");
    const Share wanted = WantedIn(ReadObject(body, {"name", "site", "version", "days"}));
    RequireSite(wanted.site);
    const NewShare made = CreateShare(context.store.database, wanted);
    Json json = ToJson(made.share);
    json["token"] = made.secret;
    // Behind '#', so that no server or proxy writes the secret into its log.
    json["url"] = "/#share=" + made.secret;
    response.set_header("Cache-Control", "no-store");
    response.set_header("Location", "/api/v1/shares/" + made.share.id);
    SendJson(response, 201, json);
  });

  routes.On("DELETE /api/v1/shares/{share}",
            [&context](const httplib::Request& request, httplib::Response& response) {
              RevokeShare(context.store.database, request.matches[1]);
              response.status = 204;
            });
}

}  // namespace parkade
