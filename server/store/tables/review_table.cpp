#include "server/store/tables/review_table.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "server/store/tables/row.h"

namespace parkade {
namespace {

using Json = nlohmann::json;

ChecklistItem ItemOf(const Json& json) {
  return {json.at("id").get<std::string>(), json.at("text").get<std::string>()};
}

}  // namespace

std::optional<std::string> ToText(const std::optional<std::vector<ChecklistItem>>& items) {
  if (!items) return std::nullopt;
  Json json = Json::array();
  for (const ChecklistItem& item : *items) json.push_back({{"id", item.id}, {"text", item.text}});
  return json.dump();
}

std::optional<std::vector<ChecklistItem>> ChecklistFromText(
    const std::optional<std::string>& text) {
  if (!text) return std::nullopt;
  std::vector<ChecklistItem> items;
  for (const Json& json : Json::parse(*text)) items.push_back(ItemOf(json));
  return items;
}

std::optional<std::string> ToText(const std::optional<std::vector<ChecklistEntry>>& entries) {
  if (!entries) return std::nullopt;
  Json list = Json::array();
  for (const ChecklistEntry& entry : *entries) {
    Json json = {{"id", entry.item.id}, {"text", entry.item.text}};
    if (entry.ticked_by) json["ticked_by"] = *entry.ticked_by;
    if (entry.ticked_at) json["ticked_at"] = *entry.ticked_at;
    list.push_back(std::move(json));
  }
  return list.dump();
}

std::optional<std::vector<ChecklistEntry>> EntriesFromText(const std::optional<std::string>& text) {
  if (!text) return std::nullopt;
  std::vector<ChecklistEntry> entries;
  for (const Json& json : Json::parse(*text)) {
    ChecklistEntry entry{ItemOf(json), std::nullopt, std::nullopt};
    if (json.contains("ticked_by")) entry.ticked_by = json.at("ticked_by").get<std::string>();
    if (json.contains("ticked_at")) entry.ticked_at = json.at("ticked_at").get<std::string>();
    entries.push_back(std::move(entry));
  }
  return entries;
}

std::vector<ChecklistEntry> WithTicks(Connection& connection, const std::string& map,
                                      const std::vector<ChecklistItem>& items) {
  std::vector<ChecklistEntry> entries;
  entries.reserve(items.size());
  for (const ChecklistItem& item : items) entries.push_back({item, std::nullopt, std::nullopt});
  Statement ticks =
      connection.Query("SELECT item, author, created_at FROM checklist_ticks WHERE map = ?", map);
  while (ticks.Step()) {
    const auto entry = std::find_if(entries.begin(), entries.end(), [&](const ChecklistEntry& of) {
      return of.item.id == ticks.Text(0);
    });
    if (entry == entries.end()) continue;  // an item that the site has no more
    entry->ticked_by = ticks.Text(1);
    entry->ticked_at = ticks.Text(2);
  }
  return entries;
}

void InsertTick(Connection& connection, const std::string& map, const std::string& item,
                const std::string& author, const std::string& now) {
  connection.Execute(
      "INSERT INTO checklist_ticks (map, item, author, created_at) VALUES (?, ?, ?, ?) ON CONFLICT "
      "(map, item) DO NOTHING",
      map, item, author, now);
}

void RemoveTick(Connection& connection, const std::string& map, const std::string& item) {
  connection.Execute("DELETE FROM checklist_ticks WHERE map = ? AND item = ?", map, item);
}

void AddReviewEntry(Connection& connection, const std::string& map, const ReviewEntry& entry) {
  connection.Execute(
      "INSERT INTO reviews (map, action, from_state, to_state, comment, author, created_at, "
      "checklist) VALUES (?, ?, ?, ?, ?, ?, ?, ?)",
      map, entry.action, std::string(ToText(entry.from)), std::string(ToText(entry.to)),
      entry.comment, entry.author, entry.created_at, ToText(entry.checklist));
  connection.Execute("UPDATE maps SET review_state = ? WHERE id = ?", std::string(ToText(entry.to)),
                     map);
}

std::vector<ReviewEntry> ListReviewEntries(Connection& connection, const std::string& map,
                                           const Page& page) {
  Statement query = connection.Query(
      R"(SELECT sequence, action, from_state, to_state, comment, author, created_at, checklist
         FROM reviews
         WHERE map = ? AND sequence < ? ORDER BY sequence DESC LIMIT ?)",
      map, page.before, page.limit);
  std::vector<ReviewEntry> entries;
  while (query.Step())
    entries.push_back({query.Integer(0), query.Text(1), ReviewStateFromText(query.Text(2)),
                       ReviewStateFromText(query.Text(3)), query.Text(4), query.Text(5),
                       query.Text(6), EntriesFromText(OptionalText(query, 7))});
  return entries;
}

std::int64_t CountReviewEntries(Connection& connection, const std::string& map) {
  Statement query = connection.Query("SELECT count(*) FROM reviews WHERE map = ?", map);
  query.Step();
  return query.Integer(0);
}

}  // namespace parkade
