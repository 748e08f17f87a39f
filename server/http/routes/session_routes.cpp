#include "core/error.h"
#include "server/http/json_response.h"
#include "server/http/routes/json_body.h"
#include "server/http/routes/routes.h"
#include "server/store/access/sessions.h"

namespace parkade {
namespace {

Json ViewOf(const Caller& caller) {
  return {{"name", caller.name},
          {"role", caller.has_link_only ? "link" : ToText(caller.role)},
          {"sites", OrNull(caller.sites)},
          {"version", OrNull(caller.version)},
          {"pictures", caller.may_see_pictures}};
}

void SendSession(RouteContext& context, int status, const std::optional<Caller>& caller,
                 const std::optional<std::string>& secret, httplib::Response& response) {
  response.set_header("Cache-Control", "no-store");
  SendJson(response, status,
           {{"access", context.gate.IsOpen() ? "open" : "token"},
            {"caller", caller ? ViewOf(*caller) : Json()},
            {"csrf", secret ? Json(CsrfTokenOf(*secret)) : Json()}});
}

/// Nobody is an answer here, and no failure.
void Show(RouteContext& context, const httplib::Request& request, httplib::Response& response) {
  const std::optional<std::string> session = CredentialsOf(request).session;
  const bool has_ended = session && !CallerOfSession(context.store.database, *session);
  if (has_ended) ClearSessionCookie(request, response);
  const std::optional<Caller> caller =
      has_ended ? std::nullopt : context.gate.Identify(request, response);
  SendSession(context, 200, caller, caller && session ? session : std::nullopt, response);
}

void Begin(RouteContext& context, const httplib::Request& request, httplib::Response& response,
           const httplib::ContentReader& body) {
  Require(!context.gate.IsOpen(), ErrorCode::kConflict,
          "this service has no tokens: everybody on its machine may do everything");
  const auto token = TextIn(ReadObject(body, {"token"}), "token");
  Require(token.has_value(), ErrorCode::kInvalidInput,
          "\"token\" is missing: a token, or what a share link ends with");
  const Caller caller = context.gate.Authenticate(*token, request, response);
  const WorkFor scope(caller);
  const std::string secret = BeginSession(context.store.database, caller);
  SetSessionCookie(request, secret, response);
  SendSession(context, 201, caller, secret, response);
}

void End(RouteContext& context, const httplib::Request& request, httplib::Response& response) {
  const std::optional<std::string> session = CredentialsOf(request).session;
  const std::optional<Caller> caller = context.gate.Identify(request, response);
  if (caller && session) {
    const WorkFor scope(*caller);
    EndSession(context.store.database, *session);
  }
  ClearSessionCookie(request, response);
  response.status = 204;
}

}  // namespace

void AddSessionRoutes(Router& routes, RouteContext& context) {
  routes.On("GET /api/v1/session",
            [&context](const httplib::Request& request, httplib::Response& response) {
              Show(context, request, response);
            });
  routes.On(
      "POST /api/v1/session",
      [&context](const httplib::Request& request, httplib::Response& response,
                 const httplib::ContentReader& body) { Begin(context, request, response, body); });
  routes.On("DELETE /api/v1/session",
            [&context](const httplib::Request& request, httplib::Response& response) {
              End(context, request, response);
            });
}

}  // namespace parkade
