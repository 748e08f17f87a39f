#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/store/tables/database.h"
#include "server/store/tables/records.h"

namespace parkade {

/// An item of a version's checklist, and who ticked it.
struct ChecklistEntry {
  ChecklistItem item;
  std::optional<std::string> ticked_by, ticked_at;  ///< nothing: it is open
};

// Lists as a column holds them: JSON; nothing for nothing.
std::optional<std::string> ToText(const std::optional<std::vector<ChecklistItem>>& items);
std::optional<std::vector<ChecklistItem>> ChecklistFromText(const std::optional<std::string>& text);
std::optional<std::string> ToText(const std::optional<std::vector<ChecklistEntry>>& entries);
std::optional<std::vector<ChecklistEntry>> EntriesFromText(const std::optional<std::string>& text);

// Rows of `reviews`: what was done with a version under review, in order. `map` is the version's
// id. The state that came of it is in the version's own row.

struct ReviewEntry {
  std::int64_t sequence = 0;
  std::string action;  ///< "submit", "approve", "reject", "reopen", "comment"
  ReviewState from = ReviewState::kDraft, to = ReviewState::kDraft;
  std::string comment;  ///< may be empty
  std::string author;
  std::string created_at;
  std::optional<std::vector<ChecklistEntry>>
      checklist;  ///< as it was when the version was approved or rejected
};

/// Keeps the entry, and makes its state the version's.
void AddReviewEntry(Connection& connection, const std::string& map, const ReviewEntry& entry);

/// Newest first.
std::vector<ReviewEntry> ListReviewEntries(Connection& connection, const std::string& map,
                                           const Page& page);
std::int64_t CountReviewEntries(Connection& connection, const std::string& map);

// Rows of `checklist_ticks`. `map` is a version's id.

/// `items` with the ticks that the version has of them.
std::vector<ChecklistEntry> WithTicks(Connection& connection, const std::string& map,
                                      const std::vector<ChecklistItem>& items);

/// The first tick of an item stays as it is.
void InsertTick(Connection& connection, const std::string& map, const std::string& item,
                const std::string& author, const std::string& now);
void RemoveTick(Connection& connection, const std::string& map, const std::string& item);

}  // namespace parkade
