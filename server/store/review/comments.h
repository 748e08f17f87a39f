#pragma once

#include <optional>
#include <string>

#include "server/store/access/caller.h"
#include "server/store/store.h"
#include "server/store/tables/comment_table.h"

namespace parkade {

// Comments on a version. Each either begins a thread, which may be pinned to something, or answers
// in one. All are durable when they return, and throw Error{kNotFound}, Error{kInvalidInput}; only
// who wrote a comment changes its text; that one or an admin deletes it (Error{kForbidden}).

struct NewComment {
  std::string text;
  std::optional<std::string> thread;  ///< id of the thread's first comment; nothing: a new thread
  CommentPin pin;
};

/// Throws Error{kConflict} where a thread or a version is full.
Comment AddComment(Store& store, const std::string& site, std::int64_t version,
                   const NewComment& comment, const std::string& author);

struct CommentChange {
  std::optional<std::string> text = {};
  std::optional<bool> is_resolved = {};  ///< of a thread, by its first comment; anyone may
};
Comment ChangeComment(Store& store, const std::string& site, std::int64_t version,
                      const std::string& id, const CommentChange& change,
                      const std::string& author);

/// A first comment that was answered stays without its text until its last answer goes.
void DeleteComment(Store& store, const std::string& site, std::int64_t version,
                   const std::string& id, const Caller& caller);

}  // namespace parkade
