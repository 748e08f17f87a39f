#include "server/store/review/checklist.h"

#include <algorithm>
#include <set>

#include "core/error.h"
#include "server/store/access/audit_log.h"
#include "server/store/tables/map_table.h"
#include "server/store/tables/names.h"
#include "server/store/tables/site_table.h"
#include "server/store/tables/text_rules.h"

namespace parkade {
namespace {

constexpr size_t kMaxItems = 50;
constexpr size_t kMaxText = 300;  // [bytes]

Checklist Read(Connection& connection, const MapVersion& map) {
  return {map.site, map.version, !FindSite(connection, map.site).review_checklist,
          EntriesOf(connection, map)};
}

}  // namespace

const std::vector<ChecklistItem>& UsualChecklist() {
  static const std::vector<ChecklistItem> usual = {
      {"coverage", "Coverage looked at: no gap where cars will drive"},
      {"degraded", "Degraded stretches looked at"},
      {"loops", "Loops looked at"},
      {"changes", "Changes against the approved version stepped through"},
      {"slots", "Slots sampled: shape and state are right"}};
  return usual;
}

void CheckChecklist(const std::vector<ChecklistItem>& items) {
  Require(items.size() <= kMaxItems, ErrorCode::kInvalidInput,
          "a checklist has at most " + std::to_string(kMaxItems) + " items");
  std::set<std::string> ids;
  for (const ChecklistItem& item : items) {
    Require(IsPlainName(item.id), ErrorCode::kInvalidInput,
            "'" + item.id + "' is no id of an item: letters, digits, '.', '-' and '_'");
    Require(ids.insert(item.id).second, ErrorCode::kInvalidInput,
            "two items of the checklist are called '" + item.id + "'");
    CheckText(item.text, {.name = "text", .max_bytes = kMaxText, .is_required = true});
  }
}

std::vector<ChecklistEntry> EntriesOf(Connection& connection, const MapVersion& map) {
  return WithTicks(connection, map.id,
                   FindSite(connection, map.site).review_checklist.value_or(UsualChecklist()));
}

Checklist ChecklistOf(Store& store, const std::string& site, std::int64_t version) {
  return store.database.Read([&](Connection& connection) {
    return Read(connection, FindMapRow(connection, site, version));
  });
}

Checklist TickItem(Store& store, const std::string& site, std::int64_t version,
                   const std::string& item, bool is_ticked, const std::string& author) {
  return store.database.Write([&](Connection& connection) {
    const MapVersion map = FindMapRow(connection, site, version);
    const std::vector<ChecklistEntry> entries = EntriesOf(connection, map);
    const bool is_known =
        std::any_of(entries.begin(), entries.end(),
                    [&](const ChecklistEntry& entry) { return entry.item.id == item; });
    Require(is_known, ErrorCode::kNotFound,
            "the checklist of site '" + site + "' has no item '" + item + "'");
    if (is_ticked)
      InsertTick(connection, map.id, item, author, NowUtc());
    else
      RemoveTick(connection, map.id, item);
    RecordAudit(connection, is_ticked ? "checklist.tick" : "checklist.untick",
                site + "/" + std::to_string(version), "{\"item\":\"" + item + "\"}");
    return Read(connection, map);
  });
}

}  // namespace parkade
