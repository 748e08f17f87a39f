#include "server/store/tables/comment_table.h"

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "server/store/tables/row.h"

namespace parkade {
namespace {

const std::string kSelect =
    "SELECT sequence, id, map, thread, text, pin, author, created_at, edited_at, resolved_at, "
    "resolved_by, deleted_at, (SELECT site FROM maps WHERE maps.id = map), "
    "(SELECT version FROM maps WHERE maps.id = map) FROM comments ";

std::optional<std::string> PinToText(const CommentPin& pin) {
  if (pin == CommentPin{}) return std::nullopt;
  nlohmann::json json;
  if (pin.point) json["point"] = *pin.point;
  if (pin.drive) json["drive"] = *pin.drive;
  if (pin.time) json["time"] = *pin.time;
  if (pin.slot) json["slot"] = *pin.slot;
  if (pin.loop) json["loop"] = *pin.loop;
  return json.dump();
}

CommentPin PinFromText(const std::optional<std::string>& text) {
  CommentPin pin;
  if (!text) return pin;
  const nlohmann::json json = nlohmann::json::parse(*text);
  if (json.contains("point")) pin.point = json.at("point").get<std::array<double, 3>>();
  if (json.contains("drive")) pin.drive = json.at("drive").get<std::string>();
  if (json.contains("time")) pin.time = json.at("time").get<double>();
  if (json.contains("slot")) pin.slot = json.at("slot").get<std::string>();
  if (json.contains("loop")) pin.loop = json.at("loop").get<std::string>();
  return pin;
}

Comment FromRow(const Statement& row) {
  Comment comment;
  comment.sequence = row.Integer(0);
  comment.id = row.Text(1);
  comment.map = row.Text(2);
  comment.thread = OptionalText(row, 3);
  comment.text = row.Text(4);
  comment.pin = PinFromText(OptionalText(row, 5));
  comment.author = row.Text(6);
  comment.created_at = row.Text(7);
  comment.edited_at = OptionalText(row, 8);
  comment.resolved_at = OptionalText(row, 9);
  comment.resolved_by = OptionalText(row, 10);
  comment.deleted_at = OptionalText(row, 11);
  comment.site = row.Text(12);
  comment.version = row.Integer(13);
  return comment;
}

}  // namespace

void InsertComment(Connection& connection, const Comment& comment) {
  connection.Execute(
      "INSERT INTO comments (id, map, thread, text, pin, author, created_at) VALUES (?, ?, ?, ?, "
      "?, ?, ?)",
      comment.id, comment.map, comment.thread, comment.text, PinToText(comment.pin), comment.author,
      comment.created_at);
}

Comment FindComment(Connection& connection, const std::string& id) {
  Statement query = connection.Query(kSelect + "WHERE id = ?", id);
  Require(query.Step(), ErrorCode::kNotFound, "there is no comment '" + id + "'");
  return FromRow(query);
}

Comment FindComment(Connection& connection, const std::string& map, const std::string& id) {
  Comment comment = FindComment(connection, id);
  Require(comment.map == map, ErrorCode::kNotFound,
          "this version has no comment '" + id + "': it belongs to another one");
  return comment;
}

std::vector<Comment> ListComments(Connection& connection, const std::string& map,
                                  const std::optional<std::string>& thread, const Page& page) {
  Statement query = connection.Query(
      kSelect +
          "WHERE map = ?1 AND sequence < ?2 AND (?3 IS NULL OR id = ?3 OR thread = ?3) ORDER BY "
          "sequence DESC LIMIT ?4",
      map, page.before, thread, page.limit);
  std::vector<Comment> comments;
  while (query.Step()) comments.push_back(FromRow(query));
  return comments;
}

std::vector<CommentThread> ListThreads(Connection& connection, const Page& page,
                                       const ThreadFilter& filter) {
  std::optional<std::int64_t> is_resolved;
  if (filter.is_resolved) is_resolved = *filter.is_resolved ? 1 : 0;
  Statement query = connection.Query(
      R"(SELECT first.id, last.sequence, last.author, last.created_at, maps.review_state,
                (SELECT count(*) FROM comments WHERE thread = first.id)
         FROM comments first
           JOIN maps ON maps.id = first.map
           JOIN comments last ON last.sequence =
             (SELECT max(sequence) FROM comments WHERE id = first.id OR thread = first.id)
         WHERE first.thread IS NULL AND maps.files_deleted_at IS NULL AND last.sequence < ?1
           AND (?2 IS NULL OR maps.site IN (SELECT value FROM json_each(?2)))
           AND (?3 IS NULL OR maps.site = ?3)
           AND (?4 IS NULL OR (first.resolved_at IS NOT NULL) = ?4)
           AND (?5 IS NULL OR maps.review_state IN (SELECT value FROM json_each(?5)))
         ORDER BY last.sequence DESC LIMIT ?6)",
      page.before, JsonOf(filter.scope), filter.site, is_resolved, JsonOf(filter.states),
      page.limit);
  std::vector<CommentThread> threads;
  while (query.Step())
    threads.push_back({query.Integer(1), FindComment(connection, query.Text(0)), query.Integer(5),
                       query.Text(2), query.Text(3), ReviewStateFromText(query.Text(4))});
  return threads;
}

CommentCounts CountComments(Connection& connection, const std::string& map) {
  Statement query = connection.Query(
      R"(SELECT count(*) FILTER (WHERE deleted_at IS NULL),
                count(*) FILTER (WHERE thread IS NULL AND resolved_at IS NULL),
                count(*) FILTER (WHERE thread IS NULL AND resolved_at IS NOT NULL)
         FROM comments WHERE map = ?)",
      map);
  query.Step();
  return {query.Integer(0), query.Integer(1), query.Integer(2)};
}

std::int64_t CountAnswers(Connection& connection, const std::string& thread) {
  Statement query = connection.Query("SELECT count(*) FROM comments WHERE thread = ?", thread);
  query.Step();
  return query.Integer(0);
}

void UpdateComment(Connection& connection, const Comment& comment) {
  connection.Execute(
      "UPDATE comments SET text = ?, edited_at = ?, resolved_at = ?, resolved_by = ?, deleted_at = "
      "? WHERE id = ?",
      comment.text, comment.edited_at, comment.resolved_at, comment.resolved_by, comment.deleted_at,
      comment.id);
}

void RemoveComment(Connection& connection, const std::string& id) {
  connection.Execute("DELETE FROM comments WHERE id = ?", id);
}

}  // namespace parkade
