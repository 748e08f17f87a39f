#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "server/store/tables/database.h"
#include "server/store/tables/records.h"
#include "server/store/tables/site_scope.h"

namespace parkade {

/// What a thread of comments is about; nothing at all: the version as a whole.
struct CommentPin {
  std::optional<std::array<double, 3>> point = {};  ///< [m] in site
  std::optional<std::string> drive = {};            ///< id
  std::optional<double> time = {};                  ///< [s] of the drive's clock
  std::optional<std::string> slot = {};             ///< id of a parking slot
  std::optional<std::string> loop = {};             ///< [DRIVE:]LOOP as report.json names it

  bool operator==(const CommentPin&) const = default;
};

struct Comment {
  std::int64_t sequence = 0;
  std::string id;
  std::string map;  ///< id of the version
  std::string site;
  std::int64_t version = 0;
  std::optional<std::string> thread;  ///< id of the comment it answers to; nothing: it is the first
  std::string text;                   ///< plain text; empty once it was deleted
  CommentPin pin;                     ///< empty in answers
  std::string author;
  std::string created_at;
  std::optional<std::string> edited_at;
  std::optional<std::string> resolved_at, resolved_by;  ///< the thread, in its first comment
  std::optional<std::string> deleted_at;  ///< a first comment that stays because of its answers
};

// Rows of `comments`.

void InsertComment(Connection& connection, const Comment& comment);

/// One comment of a version. Throws Error{kNotFound}.
Comment FindComment(Connection& connection, const std::string& map, const std::string& id);
/// The same where the version is not known.
Comment FindComment(Connection& connection, const std::string& id);

/// Newest first; only the answers of `thread` and its first comment where given.
std::vector<Comment> ListComments(Connection& connection, const std::string& map,
                                  const std::optional<std::string>& thread, const Page& page);

/// A thread as an overview shows it.
struct CommentThread {
  std::int64_t sequence = 0;  ///< of what was said last
  Comment first;
  std::int64_t num_answers = 0;
  std::string last_author, last_at;                ///< of what was said last
  ReviewState review_state = ReviewState::kDraft;  ///< of the version it is about
};

/// Which threads of all sites are asked for.
struct ThreadFilter {
  SiteScope scope = {};
  std::optional<std::string> site = {};
  std::optional<bool> is_resolved = {};
  std::vector<ReviewState> states = {};  ///< of the version; empty: any
};

/// Threads of all versions whose files are stored; those first that something was said in last.
std::vector<CommentThread> ListThreads(Connection& connection, const Page& page,
                                       const ThreadFilter& filter);

struct CommentCounts {
  std::int64_t comments = 0, open_threads = 0, resolved_threads = 0;
};
CommentCounts CountComments(Connection& connection, const std::string& map);
std::int64_t CountAnswers(Connection& connection, const std::string& thread);

/// Stores text and the times of editing, resolving and deletion.
void UpdateComment(Connection& connection, const Comment& comment);
void RemoveComment(Connection& connection, const std::string& id);

}  // namespace parkade
