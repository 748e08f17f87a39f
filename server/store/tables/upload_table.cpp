#include "server/store/tables/upload_table.h"

#include <array>

#include "core/error.h"
#include "server/store/tables/row.h"

namespace parkade {
namespace {

constexpr std::array<UploadState, 3> kStates = {UploadState::kReceiving, UploadState::kDone,
                                                UploadState::kRefused};

const std::string kSelect = R"(
  SELECT sequence, id, metadata, filename, site, rig, sha256, length, offset, state, error, error_code, drive,
         created_at, ifnull((SELECT s.expires_at FROM upload_sets s WHERE s.id = upload_set), expires_at),
         created_by, upload_set, path, first_byte
  FROM uploads )";

UploadState StateFromText(const std::string& text) {
  for (const UploadState state : kStates)
    if (text == ToText(state)) return state;
  throw Error(ErrorCode::kInternal, "the database holds an unknown state '" + text + "'");
}

Upload FromRow(const Statement& row) {
  Upload upload;
  upload.sequence = row.Integer(0);
  upload.id = row.Text(1);
  upload.metadata = row.Text(2);
  upload.filename = row.Text(3);
  upload.site = OptionalText(row, 4);
  upload.rig = OptionalText(row, 5);
  upload.sha256 = OptionalText(row, 6);
  upload.length = row.Integer(7);
  upload.offset = row.Integer(8);
  upload.state = StateFromText(row.Text(9));
  upload.error = OptionalText(row, 10);
  upload.error_code = OptionalText(row, 11);
  upload.drive = OptionalText(row, 12);
  upload.created_at = row.Text(13);
  upload.expires_at = row.Text(14);
  upload.created_by = OptionalText(row, 15);
  upload.set = OptionalText(row, 16);
  upload.path = OptionalText(row, 17);
  upload.first_byte = row.Integer(18);
  return upload;
}

std::vector<Upload> AllOf(Statement query) {
  std::vector<Upload> uploads;
  while (query.Step()) uploads.push_back(FromRow(query));
  return uploads;
}

}  // namespace

const char* ToText(UploadState state) {
  switch (state) {
    case UploadState::kReceiving: return "receiving";
    case UploadState::kDone: return "done";
    case UploadState::kRefused: break;
  }
  return "refused";
}

void InsertUpload(Connection& connection, const Upload& upload) {
  connection.Execute(
      R"(INSERT INTO uploads (id, metadata, filename, site, rig, sha256, length, created_at, expires_at,
                              created_by, upload_set, path, first_byte)
         VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?))",
      upload.id, upload.metadata, upload.filename, upload.site, upload.rig, upload.sha256,
      upload.length, upload.created_at, upload.expires_at, upload.created_by, upload.set,
      upload.path, upload.first_byte);
}

Upload FindUpload(Connection& connection, const std::string& id) {
  Statement query = connection.Query(kSelect + "WHERE id = ?", id);
  Require(query.Step(), ErrorCode::kNotFound, "there is no upload '" + id + "'");
  return FromRow(query);
}

bool HasUpload(Connection& connection, const std::string& id) {
  return connection.Query("SELECT 1 FROM uploads WHERE id = ?", id).Step();
}

std::vector<Upload> UnfinishedUploads(Connection& connection) {
  return AllOf(connection.Query(kSelect + "WHERE state = 'receiving' ORDER BY sequence"));
}

std::vector<Upload> UploadsOfSet(Connection& connection, const std::string& set) {
  return AllOf(connection.Query(kSelect + "WHERE upload_set = ? ORDER BY sequence", set));
}

std::vector<std::string> ExpiredUploads(Connection& connection, const std::string& now) {
  Statement query =
      connection.Query("SELECT id FROM uploads WHERE expires_at < ? AND upload_set IS NULL", now);
  std::vector<std::string> ids;
  while (query.Step()) ids.push_back(query.Text(0));
  return ids;
}

void SetUploadOffset(Connection& connection, const std::string& id, std::int64_t offset,
                     const std::string& expires_at) {
  connection.Execute(
      "UPDATE uploads SET offset = ?, expires_at = ? WHERE id = ? AND state = 'receiving'", offset,
      expires_at, id);
  connection.Execute(
      "UPDATE upload_sets SET expires_at = ? WHERE id = (SELECT upload_set FROM uploads WHERE id = "
      "?)",
      expires_at, id);
}

void SetUploadWhole(Connection& connection, const std::string& id) {
  connection.Execute("UPDATE uploads SET state = 'done' WHERE id = ? AND state = 'receiving'", id);
}

void SetUploadDone(Connection& connection, const std::string& id, const std::string& drive) {
  connection.Execute("UPDATE uploads SET state = 'done', offset = length, drive = ? WHERE id = ?",
                     drive, id);
}

void SetUploadRefused(Connection& connection, const std::string& id, const std::string& code,
                      const std::string& sentence) {
  connection.Execute("UPDATE uploads SET state = 'refused', error_code = ?, error = ? WHERE id = ?",
                     code, sentence, id);
}

void DeleteUpload(Connection& connection, const std::string& id) {
  connection.Execute("DELETE FROM uploads WHERE id = ?", id);
}

}  // namespace parkade
