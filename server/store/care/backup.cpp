#include "server/store/care/backup.h"

#include <algorithm>
#include <fstream>

#include "core/error.h"
#include "core/files/sha256.h"
#include "server/store/access/audit_log.h"
#include "server/store/care/stored_files.h"
#include "server/store/disk/durable_file.h"
#include "server/store/disk/growing_file.h"
#include "server/store/tables/upload_set_table.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

constexpr size_t kPieceBytes = size_t{1} << 20;
constexpr int kMaxRounds = 100;  // of drives that come or go while they are copied

fs::path DatabaseOf(const fs::path& data) { return data / "db" / "main.db"; }

Database Look(const fs::path& data) {
  Require(fs::is_regular_file(DatabaseOf(data)), ErrorCode::kInvalidInput,
          "'" + data.string() + "' is not a data directory: it has no db/main.db");
  return Database(DatabaseOf(data), DatabaseUse::kLook);
}

/// Copies by a name of its own, so that a copy that was cut short is not taken for one.
std::string CopyDurably(const fs::path& from, const fs::path& to, CareReport& report) {
  CreateDurableFolder(to.parent_path());
  const fs::path part = to.string() + ".part";
  fs::remove(part);
  GrowingFile copy = GrowingFile::Create(part, 0);
  std::ifstream stream(from, std::ios::binary);
  std::vector<char> piece(kPieceBytes);
  Sha256 hash;
  while (stream.read(piece.data(), kPieceBytes) || stream.gcount() > 0) {
    const std::string_view content(piece.data(), static_cast<size_t>(stream.gcount()));
    copy.Append(content);
    hash.Add(content);
  }
  if (!stream.eof()) {
    fs::remove(part);
    return "";
  }
  copy.Finish();
  fs::rename(part, to);
  SyncToDisk(to.parent_path());
  report.bytes += copy.size();
  return hash.Finish();
}

/// Copies a stored file unless it is there. Returns what is wrong with the original.
std::optional<std::string> CopyStored(const fs::path& from, const fs::path& to,
                                      const StoredFile& file, CareReport& report) {
  if (!LookAtStoredFile(to, file)) return std::nullopt;
  if (auto damage = LookAtStoredFile(from, file)) return damage;
  if (file.rig.empty()) {
    if (CopyDurably(from / file.path, to / file.path, report) == file.sha256) return std::nullopt;
  } else {
    for (const fs::directory_entry& entry : fs::directory_iterator(from / file.path))
      CopyDurably(entry.path(), to / file.path / entry.path().filename(), report);
    if (!CheckStoredFile(to, file)) return std::nullopt;
  }
  fs::remove_all(to / file.path);
  return "has changed on the disk";
}

/// What workers printed: nothing depends on it, but people read it.
void CopyJobLogs(const fs::path& from, const fs::path& to, CareReport& report) {
  std::error_code gone;  // attempts are tidied up meanwhile
  for (const fs::directory_entry& job : fs::directory_iterator(from / "jobs", gone))
    for (const fs::directory_entry& attempt : fs::directory_iterator(job.path(), gone)) {
      const fs::path log = attempt.path() / "log.txt";
      const fs::path target = to / log.lexically_relative(from);
      if (fs::exists(log) && !fs::exists(target)) CopyDurably(log, target, report);
    }
}

/// Copies what `files` names; the report says what is damaged.
void CopyAll(const std::vector<StoredFile>& files, const fs::path& from, const fs::path& to,
             CareReport& report) {
  report.files = std::ssize(files);
  report.damaged.clear();
  for (const StoredFile& file : files)
    if (const auto damage = CopyStored(from, to, file, report))
      report.damaged.push_back({file.path, *damage});
}

/// Whether a backup has all `files` but the damaged ones. The report is of these files then.
bool IsComplete(const std::vector<StoredFile>& files, const fs::path& target, CareReport& report) {
  std::vector<DamagedFile> damaged;
  for (const StoredFile& file : files) {
    if (!LookAtStoredFile(target, file)) continue;
    const auto found =
        std::find_if(report.damaged.begin(), report.damaged.end(),
                     [&](const DamagedFile& candidate) { return candidate.path == file.path; });
    if (found == report.damaged.end()) return false;
    damaged.push_back(*found);
  }
  report.damaged = std::move(damaged);
  report.files = std::ssize(files);
  return true;
}

std::vector<StoredFile> FilesOf(Database& database) {
  return database.Read([](Connection& connection) { return StoredFiles(connection); });
}

/// The database as it is at one moment, for another service to begin with.
void CopyDatabase(Database& from, const fs::path& to) {
  CreateDurableFolder(to.parent_path());
  const fs::path part = to.string() + ".part";
  fs::remove(part);
  from.Read([&](Connection& connection) { connection.Execute("VACUUM INTO ?", part.string()); });
  {
    Database copy(part);
    copy.Write([](Connection& connection) {
      DeleteUnfinishedUploads(connection);
      connection.Execute(
          "UPDATE jobs SET state = 'queued', pid = NULL, pid_started = NULL WHERE state = "
          "'running'");
    });
  }
  SyncToDisk(part);
  for (const char* companion : {"-wal", "-shm"}) fs::remove(to.string() + companion);
  fs::rename(part, to);
  SyncToDisk(to.parent_path());
}

}  // namespace

CareReport VerifyData(const fs::path& data, bool deep) {
  Database database = Look(data);
  CareReport report;
  for (const StoredFile& file : FilesOf(database)) {
    const auto damage = deep ? CheckStoredFile(data, file) : LookAtStoredFile(data, file);
    const bool is_stored =
        database.Read([&](Connection& connection) { return IsStored(connection, file.path); });
    if (!is_stored) continue;
    ++report.files;
    if (deep) report.bytes += file.bytes;
    if (damage) report.damaged.push_back({file.path, *damage});
  }
  if (const auto damage = database.Read(DamageOfAudit))
    report.damaged.push_back({"db/main.db", "is not as the service left it: " + *damage});
  return report;
}

CareReport BackUpData(const fs::path& data, const fs::path& target) {
  Database database = Look(data);
  CreateDurableFolder(fs::absolute(target));
  CareReport report;
  // Files first, and then the database, which may name more by then, and so on; drives that were
  // deleted meanwhile are not named any more.
  for (int round = 1;; ++round) {
    Require(round <= kMaxRounds, ErrorCode::kConflict,
            "drives come and go faster than they can be copied: try again later");
    CopyAll(FilesOf(database), data, target, report);
    CopyDatabase(database, DatabaseOf(target));
    Database copied = Look(target);
    if (IsComplete(FilesOf(copied), target, report)) break;
  }
  CopyJobLogs(data, target, report);
  return report;
}

CareReport RestoreData(const fs::path& backup, const fs::path& data) {
  Database database = Look(backup);
  Require(!fs::exists(DatabaseOf(data)), ErrorCode::kConflict,
          "'" + data.string() + "' already holds a data directory: restore to another one");
  const DataDirectory directory(data);
  CareReport report;
  CopyAll(FilesOf(database), backup, directory.root(), report);
  CopyJobLogs(backup, directory.root(), report);
  CopyDatabase(database, DatabaseOf(directory.root()));
  return report;
}

}  // namespace parkade
