#include "core/error.h"
#include "server/http/json_response.h"
#include "server/http/routes/json_body.h"
#include "server/http/routes/routes.h"
#include "server/store/access/access_rules.h"
#include "server/store/access/tokens.h"

namespace parkade {
namespace {

Json ToJson(const Token& token) {
  return {{"id", token.id},
          {"name", token.name},
          {"role", ToText(token.role)},
          {"sites", OrNull(token.sites)},
          {"pictures", token.may_see_pictures},
          {"created_at", token.created_at},
          {"expires_at", OrNull(token.expires_at)},
          {"revoked_at", OrNull(token.revoked_at)},
          {"used_at", OrNull(token.used_at)}};
}

Token WantedIn(const Json& object) {
  Token token;
  token.name = TextIn(object, "name").value_or("");
  const std::string role = TextIn(object, "role").value_or("");
  Require(RoleFromText(role).has_value(), ErrorCode::kInvalidInput,
          "\"role\" is viewer, uploader, reviewer or admin");
  token.role = *RoleFromText(role);
  token.sites = TextsIn(object, "sites");
  token.may_see_pictures = FlagIn(object, "pictures").value_or(false);
  if (const auto days = IntegerIn(object, "days")) token.expires_at = EndAfterDays(*days);
  return token;
}

}  // namespace

void AddTokenRoutes(Router& routes, RouteContext& context) {
  routes.On("GET /api/v1/tokens", [&context](const httplib::Request& request,
                                             httplib::Response& response) {
    const Page page = PageOf(request);
    std::vector<Token> tokens = context.store.database.Read(
        [&](Connection& connection) { return ListTokens(connection, WithOneMore(page)); });
    SendPage(response, page, std::move(tokens), [](const Token& token) { return ToJson(token); });
  });

  routes.On("POST /api/v1/tokens", [&context](const httplib::Request&, httplib::Response& response,
                                              const httplib::ContentReader& body) {
    // Whoever is on the machine could lock all others out otherwise.
    Require(!context.gate.IsOpen(), ErrorCode::kConflict,
            "the first token is made by the operator: parkade token create");
    const NewToken made =
        CreateToken(context.store.database,
                    WantedIn(ReadObject(body, {"name", "role", "sites", "pictures", "days"})));
    Json json = ToJson(made.token);
    json["token"] = made.secret;
    response.set_header("Cache-Control", "no-store");
    response.set_header("Location", "/api/v1/tokens/" + made.token.id);
    SendJson(response, 201, json);
  });

  routes.On("DELETE /api/v1/tokens/{token}",
            [&context](const httplib::Request& request, httplib::Response& response) {
              RevokeToken(context.store.database, request.matches[1]);
              response.status = 204;
            });
}

}  // namespace parkade
