#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/store/store.h"
#include "server/store/tables/comment_table.h"
#include "server/store/tables/map_table.h"
#include "server/store/tables/review_table.h"

namespace parkade {

// What may be done with a version under review, and the state that comes of it:
//
//            draft        in_review    approved     rejected
//   submit   in_review
//   approve               approved
//   reject                rejected     rejected
//   reopen                             in_review    in_review
//   comment  (stays)      (stays)      (stays)      (stays)

struct ReviewStep {
  std::string action;               ///< a word of the table
  std::string comment;              ///< the reason; required to reject and to comment
  std::optional<ReviewState> seen;  ///< the state that the caller decides on
};

/// Takes the step and keeps it in the history. Durable when it returns. Throws Error{kNotFound},
/// Error{kInvalidInput}, Error{kConflict} when the state is not the one that was seen, does not
/// allow the action, or the version's files were deleted.
ReviewEntry ReviewVersion(Store& store, const std::string& site, std::int64_t version,
                          const ReviewStep& step, const std::string& author);

/// A version's review as it is now.
struct ReviewStatus {
  MapVersion map;                    ///< without files and drives
  std::vector<ReviewEntry> history;  ///< a page of it, newest first
  std::int64_t num_entries = 0;      ///< of the whole history
  CommentCounts comments;
};
ReviewStatus ReviewOf(Store& store, const std::string& site, std::int64_t version,
                      const Page& page);

/// The state by its name; throws Error{kInvalidInput}.
ReviewState ParseReviewState(const std::string& text);

}  // namespace parkade
