#include "server/http/json_response.h"
#include "server/http/routes/json_body.h"
#include "server/http/routes/review_view.h"
#include "server/http/routes/routes.h"
#include "server/store/review/comments.h"
#include "server/store/tables/map_table.h"

namespace parkade {
namespace {

CommentPin PinOf(const Json& json) {
  CommentPin pin;
  const auto found = json.find("pin");
  if (found == json.end() || found->is_null()) return pin;
  RequireObject(*found, "\"pin\"", {"point", "drive", "time", "slot", "loop"});
  if (const auto point = found->find("point"); point != found->end() && !point->is_null())
    pin.point = PointOf(*point);
  pin.drive = TextIn(*found, "drive");
  pin.time = RealIn(*found, "time");
  pin.slot = TextIn(*found, "slot");
  pin.loop = TextIn(*found, "loop");
  return pin;
}

void Announce(RouteContext& context, const std::string& site, std::int64_t version,
              const std::string& id) {
  context.events.Publish("comment", site + "/" + std::to_string(version) + "/" + id);
}

void List(RouteContext& context, const httplib::Request& request, httplib::Response& response) {
  const Page page = PageOf(request);
  const auto thread = QueryParameter(request, "thread");
  std::vector<Comment> comments = context.store.database.Read([&](Connection& connection) {
    const MapVersion map =
        FindMapRow(connection, request.matches[1], std::stoll(request.matches[2]));
    return ListComments(connection, map.id, thread, WithOneMore(page));
  });
  SendPage(response, page, std::move(comments),
           [](const Comment& comment) { return ToJson(comment); });
}

void Create(RouteContext& context, const httplib::Request& request, httplib::Response& response,
            const httplib::ContentReader& body) {
  const std::string site = request.matches[1];
  const std::int64_t version = std::stoll(request.matches[2]);
  const Json json = ReadObject(body, {"text", "thread", "pin"});
  const NewComment added{TextIn(json, "text").value_or(""), TextIn(json, "thread"), PinOf(json)};
  const Comment comment = AddComment(context.store, site, version, added, CurrentCaller().name);
  Announce(context, site, version, comment.id);
  response.set_header("Location", MapAddress(site, version) + "/comments/" + comment.id);
  SendJson(response, 201, ToJson(comment));
}

void Change(RouteContext& context, const httplib::Request& request, httplib::Response& response,
            const httplib::ContentReader& body) {
  const std::string site = request.matches[1], id = request.matches[3];
  const std::int64_t version = std::stoll(request.matches[2]);
  const Json json = ReadObject(body, {"text", "resolved"});
  const CommentChange change{TextIn(json, "text"), FlagIn(json, "resolved")};
  const Comment comment =
      ChangeComment(context.store, site, version, id, change, CurrentCaller().name);
  Announce(context, site, version, id);
  SendJson(response, 200, ToJson(comment));
}

}  // namespace

void AddCommentRoutes(Router& routes, RouteContext& context) {
  using Request = httplib::Request;
  using Response = httplib::Response;
  routes.On(
      "GET /api/v1/sites/{site}/maps/{version}/comments",
      [&context](const Request& request, Response& response) { List(context, request, response); });
  routes.On(
      "POST /api/v1/sites/{site}/maps/{version}/comments",
      [&context](const Request& request, Response& response, const httplib::ContentReader& body) {
        Create(context, request, response, body);
      });
  routes.On("GET /api/v1/sites/{site}/maps/{version}/comments/{comment}",
            [&context](const Request& request, Response& response) {
              const Comment comment = context.store.database.Read([&](Connection& connection) {
                const MapVersion map =
                    FindMapRow(connection, request.matches[1], std::stoll(request.matches[2]));
                return FindComment(connection, map.id, request.matches[3]);
              });
              SendJson(response, 200, ToJson(comment));
            });
  routes.On(
      "PATCH /api/v1/sites/{site}/maps/{version}/comments/{comment}",
      [&context](const Request& request, Response& response, const httplib::ContentReader& body) {
        Change(context, request, response, body);
      });
  routes.On("DELETE /api/v1/sites/{site}/maps/{version}/comments/{comment}",
            [&context](const Request& request, Response& response) {
              const std::string site = request.matches[1], id = request.matches[3];
              const std::int64_t version = std::stoll(request.matches[2]);
              DeleteComment(context.store, site, version, id, CurrentCaller());
              Announce(context, site, version, id);
              response.status = 204;
            });
}

}  // namespace parkade
