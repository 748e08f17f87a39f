#include "server/store/review/comments.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "server/store/access/audit_log.h"
#include "server/store/tables/map_table.h"
#include "server/store/tables/names.h"
#include "server/store/tables/text_rules.h"

namespace parkade {
namespace {

constexpr size_t kMaxText = 10'000;            // [bytes]
constexpr size_t kMaxLabel = 200;              // [bytes] of a slot's or loop's name
constexpr double kFarthest = 1e7;              // [m] of a point from the site's origin
constexpr std::int64_t kMaxComments = 10'000;  // of a version
constexpr std::int64_t kMaxAnswers = 1000;     // of a thread

void CheckCommentText(const std::string& text) {
  CheckText(text,
            {.name = "text", .max_bytes = kMaxText, .is_required = true, .may_have_lines = true});
}

void CheckPin(const CommentPin& pin) {
  const int num_targets =
      (pin.point ? 1 : 0) + (pin.drive ? 1 : 0) + (pin.slot ? 1 : 0) + (pin.loop ? 1 : 0);
  Require(num_targets <= 1, ErrorCode::kInvalidInput,
          "a comment is pinned to one thing: a point, a drive and a time, a slot or a loop");
  Require(!pin.time || pin.drive, ErrorCode::kInvalidInput,
          "a time is one of a drive: name it in \"drive\"");
  if (pin.point)
    for (const double coordinate : *pin.point)
      Require(std::isfinite(coordinate) && std::abs(coordinate) <= kFarthest,
              ErrorCode::kInvalidInput, "\"point\" lies too far away to be in the site");
  Require(!pin.time || std::isfinite(*pin.time), ErrorCode::kInvalidInput,
          "\"time\" is a number of seconds");
  if (pin.slot) CheckText(*pin.slot, {.name = "slot", .max_bytes = kMaxLabel, .is_required = true});
  if (pin.loop) CheckText(*pin.loop, {.name = "loop", .max_bytes = kMaxLabel, .is_required = true});
}

void RequireDriveInMap(Connection& connection, const MapVersion& map, const std::string& drive) {
  const bool is_in =
      connection.Query("SELECT 1 FROM map_drives WHERE map = ? AND drive = ?", map.id, drive)
          .Step();
  Require(is_in, ErrorCode::kInvalidInput,
          "drive '" + drive + "' is not in version " + std::to_string(map.version));
}

void RequireOwn(const Comment& comment, const std::string& author) {
  Require(comment.author == author, ErrorCode::kForbidden,
          "only who wrote a comment changes it, or deletes it; an admin may delete it too");
}

void RequireThread(Connection& connection, const MapVersion& map, const std::string& thread) {
  const Comment first = FindComment(connection, map.id, thread);
  Require(!first.thread, ErrorCode::kInvalidInput,
          "\"thread\" is the first comment of one, and '" + thread + "' is an answer");
  Require(CountAnswers(connection, thread) < kMaxAnswers, ErrorCode::kConflict,
          "the thread has " + std::to_string(kMaxAnswers) + " answers, and takes no more");
}

/// A first comment that only stayed for its answers goes with the last.
void RemoveIfDone(Connection& connection, const std::string& map, const std::string& thread) {
  const Comment first = FindComment(connection, map, thread);
  if (first.deleted_at && CountAnswers(connection, thread) == 0) RemoveComment(connection, thread);
}

}  // namespace

Comment AddComment(Store& store, const std::string& site, std::int64_t version,
                   const NewComment& comment, const std::string& author) {
  CheckCommentText(comment.text);
  CheckPin(comment.pin);
  Require(!comment.thread || comment.pin == CommentPin{}, ErrorCode::kInvalidInput,
          "an answer is pinned to what its thread is");
  return store.database.Write([&](Connection& connection) {
    const MapVersion map = FindMapRow(connection, site, version);
    if (comment.thread) RequireThread(connection, map, *comment.thread);
    if (comment.pin.drive) RequireDriveInMap(connection, map, *comment.pin.drive);
    Require(CountComments(connection, map.id).comments < kMaxComments, ErrorCode::kConflict,
            "the version has " + std::to_string(kMaxComments) + " comments, and takes no more");
    Comment added;
    added.id = NewId();
    added.map = map.id;
    added.thread = comment.thread;
    added.text = comment.text;
    added.pin = comment.pin;
    added.author = author;
    added.created_at = NowUtc();
    InsertComment(connection, added);
    RecordAudit(connection, "comment.create", added.id);
    return FindComment(connection, added.id);
  });
}

Comment ChangeComment(Store& store, const std::string& site, std::int64_t version,
                      const std::string& id, const CommentChange& change,
                      const std::string& author) {
  if (change.text) CheckCommentText(*change.text);
  return store.database.Write([&](Connection& connection) {
    const MapVersion map = FindMapRow(connection, site, version);
    Comment comment = FindComment(connection, map.id, id);
    const std::string now = NowUtc();
    if (change.text) {
      Require(!comment.deleted_at, ErrorCode::kConflict, "the comment was deleted");
      RequireOwn(comment, author);
      comment.text = *change.text;
      comment.edited_at = now;
    }
    if (change.is_resolved) {
      Require(!comment.thread, ErrorCode::kInvalidInput,
              "a thread is resolved by its first comment");
      comment.resolved_at = *change.is_resolved ? std::optional(now) : std::nullopt;
      comment.resolved_by = *change.is_resolved ? std::optional(author) : std::nullopt;
    }
    UpdateComment(connection, comment);
    RecordAudit(connection, "comment.change", id);
    return comment;
  });
}

void DeleteComment(Store& store, const std::string& site, std::int64_t version,
                   const std::string& id, const Caller& caller) {
  WriteToMakeRoom(store, [&](Connection& connection) {
    const MapVersion map = FindMapRow(connection, site, version);
    Comment comment = FindComment(connection, map.id, id);
    Require(!comment.deleted_at, ErrorCode::kNotFound, "the comment was deleted already");
    if (caller.role != Role::kAdmin) RequireOwn(comment, caller.name);
    RecordAudit(connection, "comment.delete", id);
    if (CountAnswers(connection, id) > 0) {
      comment.text.clear();
      comment.deleted_at = NowUtc();
      UpdateComment(connection, comment);
      return;
    }
    RemoveComment(connection, id);
    if (comment.thread) RemoveIfDone(connection, map.id, *comment.thread);
  });
}

}  // namespace parkade
