#include <algorithm>

#include "core/error.h"
#include "server/http/json_response.h"
#include "server/http/routes/json_body.h"
#include "server/http/routes/review_view.h"
#include "server/http/routes/routes.h"
#include "server/store/tables/outbox.h"
#include "server/webhooks/registration.h"

namespace parkade {
namespace {

NewWebhook ParseWebhook(const httplib::ContentReader& body) {
  const Json json = ReadObject(body, {"url", "events", "site"});
  NewWebhook webhook;
  webhook.url = TextIn(json, "url").value_or("");
  webhook.site = TextIn(json, "site");
  const Json events = json.value("events", Json::array());
  const bool is_list =
      events.is_array() && std::all_of(events.begin(), events.end(),
                                       [](const Json& event) { return event.is_string(); });
  Require(is_list, ErrorCode::kInvalidInput, "\"events\" is a list of texts");
  webhook.events = events.get<std::vector<std::string>>();
  return webhook;
}

}  // namespace

void AddWebhookRoutes(Router& routes, RouteContext& context) {
  using Request = httplib::Request;
  using Response = httplib::Response;
  routes.On("GET /api/v1/webhooks", [&context](const Request& request, Response& response) {
    const Page page = PageOf(request);
    std::vector<Webhook> webhooks = context.store.database.Read(
        [&](Connection& connection) { return ListWebhooks(connection, WithOneMore(page)); });
    SendPage(response, page, std::move(webhooks),
             [](const Webhook& webhook) { return ToJson(webhook); });
  });
  routes.On("POST /api/v1/webhooks",
            [&context](const Request&, Response& response, const httplib::ContentReader& body) {
              const Webhook webhook =
                  AddWebhook(context.store, ParseWebhook(body),
                             context.options.webhooks.limits.allow_private, CurrentCaller().name);
              Json json = ToJson(webhook);
              json["secret"] = webhook.secret;
              SendJson(response, 201, json);
            });
  routes.On("DELETE /api/v1/webhooks/{webhook}",
            [&context](const Request& request, Response& response) {
              RemoveWebhook(context.store, request.matches[1]);
              response.status = 204;
            });
  routes.On("GET /api/v1/webhooks/{webhook}/deliveries", [&context](const Request& request,
                                                                    Response& response) {
    const Page page = PageOf(request);
    std::vector<Delivery> deliveries = context.store.database.Read([&](Connection& connection) {
      FindWebhook(connection, request.matches[1]);
      return ListDeliveries(connection, request.matches[1], WithOneMore(page));
    });
    SendPage(response, page, std::move(deliveries),
             [](const Delivery& delivery) { return ToJson(delivery); });
  });
  routes.On("POST /api/v1/webhooks/{webhook}/test",
            [&context](const Request& request, Response& response, const httplib::ContentReader&) {
              const std::string id = request.matches[1];
              const Delivery delivery = context.store.database.Write([&](Connection& connection) {
                FindWebhook(connection, id);
                return FindDelivery(connection, NoteTest(connection, id).id);
              });
              context.webhooks.Wake();
              SendJson(response, 202, ToJson(delivery));
            });
}

}  // namespace parkade
