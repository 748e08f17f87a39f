#include "server/store/review/site_settings.h"

#include "core/error.h"
#include "server/store/access/audit_log.h"
#include "server/store/review/checklist.h"
#include "server/store/tables/names.h"
#include "server/store/tables/rig_table.h"
#include "server/store/tables/site_table.h"
#include "server/store/tables/text_rules.h"

namespace parkade {
namespace {

constexpr size_t kMaxTitle = 200, kMaxNote = 4000;  // [bytes]
constexpr std::int64_t kMaxDays = 36'500;

void CheckDays(const std::optional<std::optional<std::int64_t>>& days) {
  const std::int64_t number = days.value_or(std::nullopt).value_or(1);
  Require(number >= 1 && number <= kMaxDays, ErrorCode::kInvalidInput,
          "what is kept is kept for 1 to " + std::to_string(kMaxDays) + " days, or for ever: null");
}

void CheckChange(const SiteChange& change) {
  if (change.title) CheckText(*change.title, {.name = "title", .max_bytes = kMaxTitle});
  if (change.note)
    CheckText(*change.note, {.name = "note", .max_bytes = kMaxNote, .may_have_lines = true});
  CheckDays(change.log_days);
  CheckDays(change.map_days);
  if (const auto& checklist = change.review_checklist.value_or(std::nullopt))
    CheckChecklist(*checklist);
}

}  // namespace

ChangedSite ChangeSite(Store& store, const std::string& name, const SiteChange& change) {
  Require(IsPlainName(name), ErrorCode::kInvalidInput, "'" + name + "' is no name of a site");
  CheckChange(change);
  return store.database.Write([&](Connection& connection) {
    const std::string rig = change.default_rig.value_or(std::nullopt).value_or("");
    Require(rig.empty() || FindRig(connection, rig).has_value(), ErrorCode::kInvalidInput,
            "there is no rig '" + rig + "': PUT /api/v1/rigs/" + rig);
    ChangedSite changed;
    changed.is_new = !HasSite(connection, name);
    EnsureSite(connection, name);
    Site site = FindSite(connection, name);
    if (change.title) site.title = *change.title;
    if (change.note) site.note = *change.note;
    if (change.log_days) site.log_days = *change.log_days;
    if (change.map_days) site.map_days = *change.map_days;
    if (change.default_rig) site.default_rig = *change.default_rig;
    if (change.review_checklist) site.review_checklist = *change.review_checklist;
    SetSiteSettings(connection, site);
    RecordAudit(connection, "site.change", name);
    changed.site = site;
    return changed;
  });
}

}  // namespace parkade
