#include "core/error.h"
#include "server/http/json_response.h"
#include "server/http/routes/json_body.h"
#include "server/http/routes/review_view.h"
#include "server/http/routes/routes.h"
#include "server/store/review/checklist.h"
#include "server/store/review/review.h"

namespace parkade {
namespace {

Json PageToJson(const Page& page, ReviewStatus status) {
  const bool has_more = status.history.size() > static_cast<size_t>(page.limit);
  if (has_more) status.history.resize(static_cast<size_t>(page.limit));
  Json json = ToJson(status);
  json["next_cursor"] =
      has_more ? Json(std::to_string(status.history.back().sequence)) : Json(nullptr);
  return json;
}

ReviewStep ParseStep(const httplib::ContentReader& body) {
  const Json json = ReadObject(body, {"action", "comment", "from"});
  ReviewStep step;
  step.action = TextIn(json, "action").value_or("");
  step.comment = TextIn(json, "comment").value_or("");
  if (const auto seen = TextIn(json, "from")) step.seen = ParseReviewState(*seen);
  return step;
}

}  // namespace

void AddReviewRoutes(Router& routes, RouteContext& context) {
  routes.On("GET /api/v1/sites/{site}/maps/{version}/review",
            [&context](const httplib::Request& request, httplib::Response& response) {
              const Page page = PageOf(request);
              SendJson(
                  response, 200,
                  PageToJson(page, ReviewOf(context.store, request.matches[1],
                                            std::stoll(request.matches[2]), WithOneMore(page))));
            });

  routes.On("POST /api/v1/sites/{site}/maps/{version}/review",
            [&context](const httplib::Request& request, httplib::Response& response,
                       const httplib::ContentReader& body) {
              const std::string site = request.matches[1];
              const std::int64_t version = std::stoll(request.matches[2]);
              ReviewVersion(context.store, site, version, ParseStep(body), CurrentCaller().name);
              context.events.Publish("review", site + "/" + std::to_string(version));
              context.webhooks.Wake();
              const Page page;
              SendJson(response, 200,
                       PageToJson(page, ReviewOf(context.store, site, version, WithOneMore(page))));
            });

  routes.On("GET /api/v1/sites/{site}/maps/{version}/checklist",
            [&context](const httplib::Request& request, httplib::Response& response) {
              SendJson(response, 200,
                       ToJson(ChecklistOf(context.store, request.matches[1],
                                          std::stoll(request.matches[2]))));
            });

  routes.On("PUT /api/v1/sites/{site}/maps/{version}/checklist/{item}",
            [&context](const httplib::Request& request, httplib::Response& response,
                       const httplib::ContentReader& body) {
              const std::string site = request.matches[1];
              const std::int64_t version = std::stoll(request.matches[2]);
              const auto is_ticked = FlagIn(ReadObject(body, {"ticked"}), "ticked");
              Require(is_ticked.has_value(), ErrorCode::kInvalidInput,
                      "\"ticked\" says whether the item is ticked: true or false");
              const Checklist checklist = TickItem(context.store, site, version, request.matches[3],
                                                   *is_ticked, CurrentCaller().name);
              context.events.Publish("review", site + "/" + std::to_string(version));
              SendJson(response, 200, ToJson(checklist));
            });
}

}  // namespace parkade
