#include "core/error.h"
#include "server/http/json_response.h"
#include "server/http/routes/json_body.h"
#include "server/http/routes/review_view.h"
#include "server/http/routes/routes.h"
#include "server/store/review/site_settings.h"
#include "server/store/tables/names.h"
#include "server/store/tables/site_table.h"

namespace parkade {
namespace {

/// Without the versions that the caller's link does not lead to; a link tells nothing of how the
/// site is kept.
Site AsSeen(Site site) {
  const auto only = CurrentCaller().version;
  if (only) std::erase_if(site.versions, [&](std::int64_t version) { return version != *only; });
  if (only && site.approved_version != only) site.approved_version.reset();
  if (CurrentCaller().has_link_only) site.review_state.reset();
  if (!CurrentCaller().has_link_only) return site;
  site.note.clear();
  site.log_days = site.map_days = std::nullopt;
  site.default_rig.reset();
  site.review_checklist.reset();
  return site;
}

/// The member where it is there: null takes the setting away.
template <typename Value, typename Read>
std::optional<std::optional<Value>> SettingIn(const Json& object, const char* member,
                                              const Read& read) {
  if (!object.contains(member)) return std::nullopt;
  return std::optional<std::optional<Value>>(std::in_place, read(object, member));
}

/// The items of a list; one that comes without an id is a new one. Null: nothing.
std::optional<std::vector<ChecklistItem>> ChecklistIn(const Json& object, const char* member) {
  const Json& list = object.at(member);
  if (list.is_null()) return std::nullopt;
  Require(list.is_array(), ErrorCode::kInvalidInput,
          std::string("\"") + member + "\" is a list of items");
  std::vector<ChecklistItem> items;
  for (const Json& item : list) {
    RequireObject(item, "an item of the checklist", {"id", "text"});
    items.push_back({TextIn(item, "id").value_or(NewId()), TextIn(item, "text").value_or("")});
  }
  return items;
}

SiteChange ParseChange(const httplib::ContentReader& body) {
  const Json json =
      ReadObject(body, {"title", "note", "retention", "default_rig", "review_checklist"});
  SiteChange change;
  change.title = TextIn(json, "title");
  change.note = TextIn(json, "note");
  change.default_rig = SettingIn<std::string>(json, "default_rig", TextIn);
  change.review_checklist =
      SettingIn<std::vector<ChecklistItem>>(json, "review_checklist", ChecklistIn);
  if (const auto retention = json.find("retention"); retention != json.end()) {
    RequireObject(*retention, "\"retention\"", {"log_days", "map_days"});
    change.log_days = SettingIn<std::int64_t>(*retention, "log_days", IntegerIn);
    change.map_days = SettingIn<std::int64_t>(*retention, "map_days", IntegerIn);
  }
  return change;
}

}  // namespace

void AddSiteRoutes(Router& routes, RouteContext& context) {
  routes.On("GET /api/v1/sites",
            [&context](const httplib::Request& request, httplib::Response& response) {
              const Page page = PageOf(request);
              const std::vector<ReviewState> states = ReviewStatesOf(request);
              Require(states.empty() || !CurrentCaller().has_link_only, ErrorCode::kInvalidInput,
                      "a link shows no states of reviews");
              std::vector<Site> sites = context.store.database.Read([&](Connection& connection) {
                return ListSites(connection, WithOneMore(page), CurrentCaller().sites, states);
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

  routes.On("PUT /api/v1/sites/{site}", [&context](const httplib::Request& request,
                                                   httplib::Response& response,
                                                   const httplib::ContentReader& body) {
    const ChangedSite changed = ChangeSite(context.store, request.matches[1], ParseChange(body));
    SendJson(response, changed.is_new ? 201 : 200, ToJson(changed.site));
  });
}

}  // namespace parkade
