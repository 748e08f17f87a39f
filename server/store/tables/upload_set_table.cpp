#include "server/store/tables/upload_set_table.h"

#include <array>

#include "core/error.h"
#include "server/store/tables/row.h"

namespace parkade {
namespace {

const std::string kSelectSet =
    "SELECT id, filename, site, rig, bytes, state, error, error_code, drive, created_at, "
    "expires_at, created_by FROM upload_sets ";
const std::string kIsUnfinished = "state IN ('receiving', 'assembling') ";

UploadSetState SetStateFromText(const std::string& text) {
  for (const UploadSetState state : {UploadSetState::kReceiving, UploadSetState::kAssembling,
                                     UploadSetState::kDone, UploadSetState::kRefused})
    if (text == ToText(state)) return state;
  throw Error(ErrorCode::kInternal, "the database holds an unknown state '" + text + "'");
}

UploadSet SetFromRow(const Statement& row) {
  UploadSet set;
  set.id = row.Text(0);
  set.filename = row.Text(1);
  set.site = OptionalText(row, 2);
  set.rig = OptionalText(row, 3);
  set.bytes = row.Integer(4);
  set.state = SetStateFromText(row.Text(5));
  set.error = OptionalText(row, 6);
  set.error_code = OptionalText(row, 7);
  set.drive = OptionalText(row, 8);
  set.created_at = row.Text(9);
  set.expires_at = row.Text(10);
  set.created_by = OptionalText(row, 11);
  return set;
}

std::vector<UploadSet> SetsOf(Statement query) {
  std::vector<UploadSet> sets;
  while (query.Step()) sets.push_back(SetFromRow(query));
  return sets;
}

}  // namespace

const char* ToText(UploadSetState state) {
  switch (state) {
    case UploadSetState::kReceiving: return "receiving";
    case UploadSetState::kAssembling: return "assembling";
    case UploadSetState::kDone: return "done";
    case UploadSetState::kRefused: break;
  }
  return "refused";
}

void InsertUploadSet(Connection& connection, const UploadSet& set) {
  connection.Execute(
      R"(INSERT INTO upload_sets (id, filename, site, rig, bytes, created_at, expires_at, created_by)
         VALUES (?, ?, ?, ?, ?, ?, ?, ?))",
      set.id, set.filename, set.site, set.rig, set.bytes, set.created_at, set.expires_at,
      set.created_by);
}

UploadSet FindUploadSet(Connection& connection, const std::string& id) {
  Statement query = connection.Query(kSelectSet + "WHERE id = ?", id);
  Require(query.Step(), ErrorCode::kNotFound, "there is no upload set '" + id + "'");
  return SetFromRow(query);
}

std::vector<UploadSet> UnfinishedUploadSets(Connection& connection) {
  return SetsOf(connection.Query(kSelectSet + "WHERE " + kIsUnfinished + "ORDER BY sequence"));
}

std::vector<UploadSet> WholeUploadSets(Connection& connection) {
  return SetsOf(connection.Query(kSelectSet + "WHERE " + kIsUnfinished +
                                 "AND NOT EXISTS (SELECT 1 FROM uploads u WHERE u.upload_set = "
                                 "upload_sets.id AND u.state != 'done') ORDER BY sequence"));
}

std::vector<std::string> ExpiredUploadSets(Connection& connection, const std::string& now) {
  Statement query = connection.Query("SELECT id FROM upload_sets WHERE expires_at < ?", now);
  std::vector<std::string> ids;
  while (query.Step()) ids.push_back(query.Text(0));
  return ids;
}

void SetUploadSetAssembling(Connection& connection, const std::string& id) {
  connection.Execute("UPDATE upload_sets SET state = 'assembling' WHERE id = ?", id);
}

void SetUploadSetDone(Connection& connection, const std::string& id, const std::string& drive) {
  connection.Execute("UPDATE upload_sets SET state = 'done', drive = ? WHERE id = ?", drive, id);
  connection.Execute("UPDATE uploads SET drive = ? WHERE upload_set = ?", drive, id);
}

void SetUploadSetRefused(Connection& connection, const std::string& id, const std::string& code,
                         const std::string& sentence) {
  for (const std::string to :
       {"upload_sets SET state = 'refused', error_code = ?, error = ? WHERE id",
        "uploads SET state = 'refused', error_code = ?, error = ? WHERE upload_set"})
    connection.Execute("UPDATE " + to + " = ?", code, sentence, id);
}

void DeleteUploadSet(Connection& connection, const std::string& id) {
  connection.Execute("DELETE FROM uploads WHERE upload_set = ?", id);
  connection.Execute("DELETE FROM upload_sets WHERE id = ?", id);
}

void DeleteUnfinishedUploads(Connection& connection) {
  for (const UploadSet& set : UnfinishedUploadSets(connection)) DeleteUploadSet(connection, set.id);
  connection.Execute("DELETE FROM uploads WHERE state = 'receiving'");
}

}  // namespace parkade
