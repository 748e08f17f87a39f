#include "server/store/tables/site_table.h"

#include "core/error.h"
#include "server/store/tables/names.h"
#include "server/store/tables/review_table.h"
#include "server/store/tables/row.h"

namespace parkade {
namespace {

const std::string kSelect = R"(
  SELECT sequence, name, created_at,
         (SELECT count(*) FROM drives WHERE site = sites.name AND deleted_at IS NULL),
         (SELECT datum FROM maps WHERE site = sites.name ORDER BY version DESC LIMIT 1),
         (SELECT bounds FROM maps WHERE site = sites.name ORDER BY version DESC LIMIT 1),
         (SELECT max(version) FROM maps WHERE site = sites.name AND review_state = 'approved'),
         title, note, log_days, map_days, default_rig, review_checklist,
         (SELECT review_state FROM maps WHERE site = sites.name ORDER BY version DESC LIMIT 1)
           AS latest_state
  FROM sites )";

Site FromRow(Connection& connection, const Statement& row) {
  Site site;
  site.sequence = row.Integer(0);
  site.name = row.Text(1);
  site.created_at = row.Text(2);
  site.num_drives = row.Integer(3);
  site.datum = OptionalText(row, 4);
  site.bounds = OptionalText(row, 5);
  site.approved_version = OptionalInteger(row, 6);
  site.title = row.Text(7);
  site.note = row.Text(8);
  site.log_days = OptionalInteger(row, 9);
  site.map_days = OptionalInteger(row, 10);
  site.default_rig = OptionalText(row, 11);
  site.review_checklist = ChecklistFromText(OptionalText(row, 12));
  if (const auto state = OptionalText(row, 13)) site.review_state = ReviewStateFromText(*state);
  Statement versions =
      connection.Query("SELECT version FROM maps WHERE site = ? ORDER BY version", site.name);
  while (versions.Step()) site.versions.push_back(versions.Integer(0));
  return site;
}

}  // namespace

void EnsureSite(Connection& connection, const std::string& name) {
  connection.Execute(
      "INSERT INTO sites (name, created_at) VALUES (?, ?) ON CONFLICT (name) DO NOTHING", name,
      NowUtc());
}

bool HasSite(Connection& connection, const std::string& name) {
  return connection.Query("SELECT 1 FROM sites WHERE name = ?", name).Step();
}

void SetSiteSettings(Connection& connection, const Site& site) {
  connection.Execute(
      "UPDATE sites SET title = ?, note = ?, log_days = ?, map_days = ?, default_rig = ?, "
      "review_checklist = ? WHERE name = ?",
      site.title, site.note, site.log_days, site.map_days, site.default_rig,
      ToText(site.review_checklist), site.name);
}

std::optional<std::string> DefaultRigOf(Connection& connection, const std::string& site) {
  Statement query = connection.Query("SELECT default_rig FROM sites WHERE name = ?", site);
  return query.Step() ? OptionalText(query, 0) : std::nullopt;
}

std::string FreeSiteName(Connection& connection, const std::string& wanted) {
  std::string name = wanted;
  for (int number = 2; HasSite(connection, name); ++number)
    name = wanted + "-" + std::to_string(number);
  return name;
}

Site FindSite(Connection& connection, const std::string& name) {
  Statement query = connection.Query(kSelect + "WHERE name = ?", name);
  Require(query.Step(), ErrorCode::kNotFound, "there is no site '" + name + "'");
  return FromRow(connection, query);
}

std::vector<Site> ListSites(Connection& connection, const Page& page, const SiteScope& scope,
                            const std::vector<ReviewState>& states) {
  Statement query = connection.Query(
      kSelect +
          "WHERE sequence < ?1 AND (?2 IS NULL OR name IN (SELECT value FROM json_each(?2))) AND "
          "(?3 IS NULL OR latest_state IN (SELECT value FROM json_each(?3))) ORDER BY sequence "
          "DESC LIMIT ?4",
      page.before, JsonOf(scope), JsonOf(states), page.limit);
  std::vector<Site> sites;
  while (query.Step()) sites.push_back(FromRow(connection, query));
  return sites;
}

}  // namespace parkade
