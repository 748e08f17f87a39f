#include "server/store/tables/drive_table.h"

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "server/store/tables/names.h"
#include "server/store/tables/row.h"

namespace parkade {
namespace {

const std::string kSelect = R"(
  SELECT sequence, id, name, filename, site, rig, state, error, bytes, sha256, streams, created_at, updated_at,
         (SELECT j.id FROM job_drives jd JOIN jobs j ON j.id = jd.job WHERE jd.drive = drives.id
            ORDER BY j.sequence DESC LIMIT 1),
         (SELECT m.version FROM map_drives md JOIN maps m ON m.id = md.map WHERE md.drive = drives.id
            ORDER BY m.sequence DESC LIMIT 1),
         inspection_state, created_by, log_deleted_at
  FROM drives )";

Drive FromRow(const Statement& row) {
  Drive drive;
  drive.sequence = row.Integer(0);
  drive.id = row.Text(1);
  drive.name = row.Text(2);
  drive.filename = row.Text(3);
  drive.site = row.Text(4);
  drive.rig = OptionalText(row, 5);
  drive.state = DriveStateFromText(row.Text(6));
  drive.error = OptionalText(row, 7);
  drive.bytes = row.Integer(8);
  drive.sha256 = row.Text(9);
  drive.streams = OptionalText(row, 10);
  drive.created_at = row.Text(11);
  drive.updated_at = row.Text(12);
  drive.job = OptionalText(row, 13);
  drive.map_version = OptionalInteger(row, 14);
  drive.inspection_state = OptionalText(row, 15);
  drive.created_by = OptionalText(row, 16);
  drive.log_deleted_at = OptionalText(row, 17);
  return drive;
}

Drive Only(Statement query, const std::string& id) {
  Require(query.Step(), ErrorCode::kNotFound, "there is no drive '" + id + "'");
  return FromRow(query);
}

}  // namespace

void InsertDrive(Connection& connection, const Drive& drive) {
  connection.Execute(
      R"(INSERT INTO drives (id, name, filename, site, rig, state, bytes, sha256, created_at, updated_at,
                             inspection_state, created_by)
         VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?))",
      drive.id, drive.name, drive.filename, drive.site, drive.rig, std::string(ToText(drive.state)),
      drive.bytes, drive.sha256, drive.created_at, drive.updated_at, drive.inspection_state,
      drive.created_by);
}

std::optional<Drive> NextDriveToInspect(Connection& connection) {
  Statement query = connection.Query(
      kSelect +
          "WHERE inspection_state = ? AND deleted_at IS NULL AND log_deleted_at IS NULL ORDER BY "
          "sequence LIMIT 1",
      kWaiting);
  if (!query.Step()) return std::nullopt;
  return FromRow(query);
}

void SetDriveInspection(Connection& connection, const std::string& id,
                        const DriveInspection& inspection) {
  connection.Execute(
      "UPDATE drives SET inspection_state = ?, inspection = ?, updated_at = ? WHERE id = ?",
      inspection.state, inspection.json, NowUtc(), id);
}

std::optional<std::string> InspectionOf(Connection& connection, const std::string& id) {
  Statement query = connection.Query("SELECT inspection FROM drives WHERE id = ?", id);
  return query.Step() ? OptionalText(query, 0) : std::nullopt;
}

Drive FindDrive(Connection& connection, const std::string& id) {
  return Only(connection.Query(kSelect + "WHERE id = ? AND deleted_at IS NULL", id), id);
}

bool HasLog(Connection& connection, const std::string& id) {
  return connection
      .Query("SELECT 1 FROM drives WHERE id = ? AND deleted_at IS NULL AND log_deleted_at IS NULL",
             id)
      .Step();
}

Drive FindDriveOrTombstone(Connection& connection, const std::string& id) {
  return Only(connection.Query(kSelect + "WHERE id = ?", id), id);
}

std::vector<Drive> ListDrives(Connection& connection, const Page& page,
                              const std::optional<std::string>& site, const SiteScope& scope) {
  std::vector<Drive> drives;
  Statement query = connection.Query(
      kSelect +
          "WHERE sequence < ? AND (?2 IS NULL OR site = ?2) AND (?3 IS NULL OR site IN (SELECT "
          "value FROM json_each(?3))) AND deleted_at IS NULL ORDER BY sequence DESC LIMIT ?",
      page.before, site, JsonOf(scope), page.limit);
  while (query.Step()) drives.push_back(FromRow(query));
  return drives;
}

std::vector<std::string> DrivesOfSite(Connection& connection, const std::string& site) {
  return Texts(
      connection.Query("SELECT id FROM drives WHERE site = ? AND deleted_at IS NULL AND "
                       "log_deleted_at IS NULL ORDER "
                       "BY sequence",
                       site));
}

std::vector<std::string> DrivesToJoin(Connection& connection, const std::string& new_drive,
                                      const std::vector<std::string>& beside) {
  return Texts(connection.Query(R"(
      WITH newest AS (SELECT * FROM drives WHERE id = ?1 AND deleted_at IS NULL),
           usable AS (
        SELECT d.*, d.id = n.id OR d.id IN (SELECT value FROM json_each(?2)) AS is_new FROM newest n JOIN drives d ON d.site = n.site
          WHERE d.deleted_at IS NULL AND d.log_deleted_at IS NULL AND (is_new OR d.state = 'ready'))
      SELECT id FROM usable d
        WHERE NOT EXISTS (SELECT 1 FROM usable other WHERE other.sha256 = d.sha256
                            AND (other.is_new, other.sequence) > (d.is_new, d.sequence))
      ORDER BY sequence)",
                                new_drive, nlohmann::json(beside).dump()));
}

std::string FreeDriveName(Connection& connection, const std::string& site,
                          const std::string& wanted) {
  const auto is_taken = [&](const std::string& name) {
    return connection.Query("SELECT 1 FROM drives WHERE site = ? AND name = ?", site, name).Step();
  };
  std::string name = wanted;
  for (int number = 2; is_taken(name); ++number) name = wanted + "-" + std::to_string(number);
  return name;
}

void SetDriveState(Connection& connection, const std::string& id, DriveState state,
                   const std::optional<std::string>& error) {
  connection.Execute("UPDATE drives SET state = ?, error = ?, updated_at = ? WHERE id = ?",
                     std::string(ToText(state)), error, NowUtc(), id);
}

void SetDriveStreams(Connection& connection, const std::string& id,
                     const std::string& streams_json) {
  connection.Execute("UPDATE drives SET streams = ?, updated_at = ? WHERE id = ?", streams_json,
                     NowUtc(), id);
}

void MarkDriveDeleted(Connection& connection, const std::string& id) {
  connection.Execute("UPDATE drives SET deleted_at = ?, log_deleted_at = NULL WHERE id = ?",
                     NowUtc(), id);
}

void MarkLogDeleted(Connection& connection, const std::string& id, const std::string& now) {
  connection.Execute("UPDATE drives SET log_deleted_at = ?, updated_at = ? WHERE id = ?", now, now,
                     id);
}

void RequireLog(const Drive& drive) {
  Require(!drive.log_deleted_at, ErrorCode::kConflict,
          "the log of drive '" + drive.name + "' was deleted on " +
              drive.log_deleted_at.value_or("").substr(0, 10) +
              ", as the retention of its site says: upload it again");
}

std::int64_t CountDrivesWithContent(Connection& connection, const std::string& sha256) {
  Statement query = connection.Query(
      "SELECT count(*) FROM drives WHERE sha256 = ? AND deleted_at IS NULL AND log_deleted_at IS "
      "NULL",
      sha256);
  query.Step();
  return query.Integer(0);
}

bool HasMap(Connection& connection, const std::string& drive_id) {
  return connection.Query("SELECT 1 FROM map_drives WHERE drive = ? LIMIT 1", drive_id).Step();
}

}  // namespace parkade
