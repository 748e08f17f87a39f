#include "server/store/tables/schema.h"

#include <array>
#include <vector>

#include "core/error.h"
#include "server/store/tables/review_schema.h"

namespace parkade {
namespace {

// `sequence` gives the order of arrival and is what cursors of lists hold; `id`
// is what the outside sees. Times are RFC 3339 in UTC. Tables WITHOUT ROWID name
// their key's columns first: quick_check of SQLite 3.40 reports damage otherwise.
const std::vector<const char*> kVersion1 = {
    R"(CREATE TABLE sites (
         sequence INTEGER PRIMARY KEY AUTOINCREMENT,
         name TEXT NOT NULL UNIQUE,
         created_at TEXT NOT NULL) STRICT)",

    R"(CREATE TABLE rigs (
         sequence INTEGER PRIMARY KEY AUTOINCREMENT,
         id TEXT NOT NULL UNIQUE,
         name TEXT NOT NULL,
         sha256 TEXT NOT NULL,
         files TEXT NOT NULL,
         created_at TEXT NOT NULL) STRICT)",
    "CREATE INDEX rigs_by_name ON rigs (name, sequence)",

    R"(CREATE TABLE drives (
         sequence INTEGER PRIMARY KEY AUTOINCREMENT,
         id TEXT NOT NULL UNIQUE,
         name TEXT NOT NULL,
         filename TEXT NOT NULL,
         site TEXT NOT NULL REFERENCES sites (name),
         rig TEXT,
         state TEXT NOT NULL CHECK (state IN ('received', 'queued', 'processing', 'ready', 'failed')),
         error TEXT,
         bytes INTEGER NOT NULL,
         sha256 TEXT NOT NULL,
         streams TEXT,
         created_at TEXT NOT NULL,
         updated_at TEXT NOT NULL,
         deleted_at TEXT) STRICT)",
    "CREATE INDEX drives_by_site ON drives (site, sequence)",
    "CREATE INDEX drives_by_content ON drives (sha256)",

    R"(CREATE TABLE jobs (
         sequence INTEGER PRIMARY KEY AUTOINCREMENT,
         id TEXT NOT NULL UNIQUE,
         site TEXT NOT NULL REFERENCES sites (name),
         state TEXT NOT NULL CHECK (state IN ('queued', 'running', 'done', 'failed', 'cancelled')),
         attempt INTEGER NOT NULL DEFAULT 0,
         crashes INTEGER NOT NULL DEFAULT 0,
         error TEXT,
         error_code TEXT,
         pid INTEGER,
         pid_started INTEGER,
         map_version INTEGER,
         created_at TEXT NOT NULL,
         started_at TEXT,
         finished_at TEXT) STRICT)",
    "CREATE INDEX jobs_by_state ON jobs (state, sequence)",

    R"(CREATE TABLE job_drives (
         job TEXT NOT NULL REFERENCES jobs (id),
         position INTEGER NOT NULL,
         drive TEXT NOT NULL REFERENCES drives (id),
         PRIMARY KEY (job, position)) STRICT, WITHOUT ROWID)",
    "CREATE INDEX job_drives_by_drive ON job_drives (drive)",

    R"(CREATE TABLE maps (
         sequence INTEGER PRIMARY KEY AUTOINCREMENT,
         id TEXT NOT NULL UNIQUE,
         site TEXT NOT NULL REFERENCES sites (name),
         version INTEGER NOT NULL,
         job TEXT NOT NULL REFERENCES jobs (id),
         sha256 TEXT NOT NULL,
         datum TEXT,
         bounds TEXT,
         created_at TEXT NOT NULL,
         UNIQUE (site, version)) STRICT)",

    R"(CREATE TABLE map_files (
         map TEXT NOT NULL REFERENCES maps (id),
         name TEXT NOT NULL,
         bytes INTEGER NOT NULL,
         sha256 TEXT NOT NULL,
         PRIMARY KEY (map, name)) STRICT, WITHOUT ROWID)",

    R"(CREATE TABLE map_drives (
         map TEXT NOT NULL REFERENCES maps (id),
         position INTEGER NOT NULL,
         drive TEXT NOT NULL REFERENCES drives (id),
         PRIMARY KEY (map, position)) STRICT, WITHOUT ROWID)",
    "CREATE INDEX map_drives_by_drive ON map_drives (drive)",
};

// A review's wishes for the job, JSON; NULL: none.
const std::vector<const char*> kVersion2 = {"ALTER TABLE jobs ADD COLUMN review TEXT"};

// How often the service ended while the job was running, other than by being stopped.
const std::vector<const char*> kVersion3 = {
    "ALTER TABLE jobs ADD COLUMN service_ends INTEGER NOT NULL DEFAULT 0"};

// The drive whose upload made the job, which joins it with its site when it starts; NULL: the
// drives were chosen, or an older program queued the job. Drives in a map are ready: older programs
// said otherwise while a job ran.
const std::vector<const char*> kVersion4 = {
    "ALTER TABLE jobs ADD COLUMN new_drive TEXT REFERENCES drives (id)",
    "UPDATE drives SET state = 'ready', error = NULL WHERE state != 'ready' AND id IN (SELECT "
    "drive FROM map_drives)"};

// Logs that arrive in parts (tus), what a first look at a log found, sums of the pieces of maps'
// files, and when stored files were last compared with what these tables say of them.
const std::vector<const char*> kVersion5 = {
    R"(CREATE TABLE uploads (
         sequence INTEGER PRIMARY KEY AUTOINCREMENT,
         id TEXT NOT NULL UNIQUE,
         metadata TEXT NOT NULL,
         filename TEXT NOT NULL,
         site TEXT,
         rig TEXT,
         sha256 TEXT,
         length INTEGER NOT NULL,
         offset INTEGER NOT NULL DEFAULT 0,
         state TEXT NOT NULL DEFAULT 'receiving' CHECK (state IN ('receiving', 'done', 'refused')),
         error TEXT,
         error_code TEXT,
         drive TEXT REFERENCES drives (id),
         created_at TEXT NOT NULL,
         expires_at TEXT NOT NULL) STRICT)",
    "CREATE INDEX uploads_by_state ON uploads (state, expires_at)",
    "ALTER TABLE map_files ADD COLUMN pieces TEXT",
    "ALTER TABLE drives ADD COLUMN inspection_state TEXT",
    "ALTER TABLE drives ADD COLUMN inspection TEXT",
    "CREATE INDEX drives_by_inspection ON drives (inspection_state, sequence)",
    R"(CREATE TABLE file_checks (
         path TEXT NOT NULL PRIMARY KEY,
         checked_at TEXT NOT NULL,
         damage TEXT) STRICT, WITHOUT ROWID)"};

// When a queued job may start at the earliest; NULL: at once.
const std::vector<const char*> kVersion6 = {"ALTER TABLE jobs ADD COLUMN not_before TEXT"};

// Who may do what, and who did. Secrets are kept as their SHA-256; `sites` is a JSON list, NULL for
// all; `created_by` is the id of a token, NULL where none was needed.
const std::vector<const char*> kVersion7 = {
    R"(CREATE TABLE tokens (
         sequence INTEGER PRIMARY KEY AUTOINCREMENT,
         id TEXT NOT NULL UNIQUE,
         name TEXT NOT NULL,
         role TEXT NOT NULL CHECK (role IN ('viewer', 'uploader', 'reviewer', 'admin')),
         sites TEXT,
         pictures INTEGER NOT NULL,
         secret_sha256 TEXT NOT NULL UNIQUE,
         created_at TEXT NOT NULL,
         expires_at TEXT,
         revoked_at TEXT,
         used_at TEXT) STRICT)",
    R"(CREATE TABLE shares (
         sequence INTEGER PRIMARY KEY AUTOINCREMENT,
         id TEXT NOT NULL UNIQUE,
         name TEXT NOT NULL,
         site TEXT NOT NULL REFERENCES sites (name),
         version INTEGER,
         secret_sha256 TEXT NOT NULL UNIQUE,
         created_by TEXT NOT NULL,
         created_at TEXT NOT NULL,
         expires_at TEXT NOT NULL,
         revoked_at TEXT) STRICT)",
    R"(CREATE TABLE sessions (
         secret_sha256 TEXT NOT NULL PRIMARY KEY,
         token TEXT REFERENCES tokens (id),
         share TEXT REFERENCES shares (id),
         created_at TEXT NOT NULL,
         used_at TEXT NOT NULL,
         expires_at TEXT NOT NULL) STRICT, WITHOUT ROWID)",
    R"(CREATE TABLE audit (
         sequence INTEGER PRIMARY KEY AUTOINCREMENT,
         at TEXT NOT NULL,
         caller TEXT NOT NULL,
         caller_name TEXT NOT NULL,
         address TEXT NOT NULL,
         action TEXT NOT NULL,
         subject TEXT NOT NULL,
         detail TEXT NOT NULL,
         sha256 TEXT NOT NULL) STRICT)",
    "ALTER TABLE drives ADD COLUMN created_by TEXT",
    "ALTER TABLE uploads ADD COLUMN created_by TEXT"};

// Where the latest attempt is: with which engine, what that one calls it, and whether it waits
// there.
const std::vector<const char*> kVersion9 = {
    "ALTER TABLE jobs ADD COLUMN engine TEXT", "ALTER TABLE jobs ADD COLUMN engine_id TEXT",
    "ALTER TABLE jobs ADD COLUMN engine_waits INTEGER NOT NULL DEFAULT 0",
    "UPDATE jobs SET engine = 'local' WHERE pid IS NOT NULL"};

// Uploads that are the parts of one drive. Their bytes go to their places, from `first_byte` on, in
// one file of the set, which becomes the log: `bytes` long.
const std::vector<const char*> kVersion10 = {
    R"(CREATE TABLE upload_sets (
         sequence INTEGER PRIMARY KEY AUTOINCREMENT,
         id TEXT NOT NULL UNIQUE,
         filename TEXT NOT NULL,
         site TEXT,
         rig TEXT,
         bytes INTEGER NOT NULL,
         state TEXT NOT NULL DEFAULT 'receiving' CHECK (state IN ('receiving', 'assembling', 'done', 'refused')),
         error TEXT,
         error_code TEXT,
         drive TEXT REFERENCES drives (id),
         created_at TEXT NOT NULL,
         expires_at TEXT NOT NULL,
         created_by TEXT) STRICT)",
    "CREATE INDEX upload_sets_by_state ON upload_sets (state, expires_at)",
    "ALTER TABLE uploads ADD COLUMN upload_set TEXT REFERENCES upload_sets (id)",
    "ALTER TABLE uploads ADD COLUMN path TEXT",
    "ALTER TABLE uploads ADD COLUMN first_byte INTEGER NOT NULL DEFAULT 0",
    "CREATE INDEX uploads_by_set ON uploads (upload_set, sequence)"};

// Whether a running job is to end as cancelled, which a service may not live to see.
const std::vector<const char*> kVersion11 = {
    "ALTER TABLE jobs ADD COLUMN cancel_asked INTEGER NOT NULL DEFAULT 0"};

// What reviewers look at: the site's own list (JSON; NULL: the usual one), what is ticked of it for
// a version, and what was ticked when a version was decided on. The stage in which a job's
// latest attempt ended without a map.
const std::vector<const char*> kVersion12 = {"ALTER TABLE sites ADD COLUMN review_checklist TEXT",
                                             R"(CREATE TABLE checklist_ticks (
         map TEXT NOT NULL REFERENCES maps (id),
         item TEXT NOT NULL,
         author TEXT NOT NULL,
         created_at TEXT NOT NULL,
         PRIMARY KEY (map, item)) STRICT, WITHOUT ROWID)",
                                             "ALTER TABLE reviews ADD COLUMN checklist TEXT",
                                             "ALTER TABLE jobs ADD COLUMN last_stage TEXT"};

// One entry per schema version, oldest first. A published entry never changes:
// a change of the tables is a new entry.
const std::vector<const std::vector<const char*>*> kMigrations = {
    &kVersion1, &kVersion2,     &kVersion3, &kVersion4,  &kVersion5,  &kVersion6,
    &kVersion7, &kReviewSchema, &kVersion9, &kVersion10, &kVersion11, &kVersion12};

size_t FoundVersion(Connection& connection) {
  Statement query = connection.Query("PRAGMA user_version");
  query.Step();
  return static_cast<size_t>(query.Integer(0));
}

}  // namespace

void RequireSchema(Connection& connection) {
  Require(FoundVersion(connection) == kMigrations.size(), ErrorCode::kConflict,
          "the data directory was written by another version of this program: an older one's is "
          "taken over when the service starts");
}

void MigrateSchema(Connection& connection) {
  const size_t found = FoundVersion(connection);
  Require(found <= kMigrations.size(), ErrorCode::kConflict,
          "the data directory was written by a newer version of this program");
  // A service has to start on a full disk.
  if (found == kMigrations.size()) return;
  for (size_t version = found; version < kMigrations.size(); ++version)
    for (const char* statement : *kMigrations[version]) connection.Execute(statement);
  connection.Execute("PRAGMA user_version=" + std::to_string(kMigrations.size()));
}

}  // namespace parkade
