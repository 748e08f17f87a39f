#pragma once

#include <string>
#include <vector>

#include "server/store/tables/database.h"
#include "server/store/tables/records.h"

namespace parkade {

// Rows of `reviews`: what was done with a version under review, in order. `map` is the version's
// id. The state that came of it is in the version's own row.

struct ReviewEntry {
  std::int64_t sequence = 0;
  std::string action;  ///< "submit", "approve", "reject", "reopen", "comment"
  ReviewState from = ReviewState::kDraft, to = ReviewState::kDraft;
  std::string comment;  ///< may be empty
  std::string author;
  std::string created_at;
};

/// Keeps the entry, and makes its state the version's.
void AddReviewEntry(Connection& connection, const std::string& map, const ReviewEntry& entry);

/// Newest first.
std::vector<ReviewEntry> ListReviewEntries(Connection& connection, const std::string& map,
                                           const Page& page);
std::int64_t CountReviewEntries(Connection& connection, const std::string& map);

}  // namespace parkade
