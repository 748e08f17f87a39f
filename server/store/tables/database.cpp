#include "server/store/tables/database.h"

#include <sqlite3.h>

#include "core/error.h"
#include "core/log.h"
#include "server/store/disk/durable_file.h"
#include "server/store/tables/schema.h"

namespace parkade {
namespace {

constexpr int kLongLogPages = 1000;

std::atomic<bool> has_folder_sync_failed = false;

/// SQLite opens the folder of a new file to sync it, and does not look whether that worked. So this
/// syncs it in its place; "cannot open" lets SQLite go on without doing it again.
int SyncFolderOf(const char* file, int* folder_fd) {
  *folder_fd = -1;
  try {
    SyncToDisk(std::filesystem::path(file).parent_path());
  } catch (const std::exception&) {
    has_folder_sync_failed = true;
  }
  return SQLITE_CANTOPEN;
}

void WatchFolderSyncs() {
  sqlite3_vfs* vfs = sqlite3_vfs_find(nullptr);
  vfs->xSetSystemCall(vfs, "openDirectory", reinterpret_cast<sqlite3_syscall_ptr>(&SyncFolderOf));
}

}  // namespace

Database::Transaction::Transaction(Connection& connection) : connection_(connection) {
  connection_.Execute("BEGIN IMMEDIATE");
}

Database::Transaction::~Transaction() {
  if (!is_open_) return;
  try {
    connection_.Execute("ROLLBACK");
  } catch (const Error&) {
    // SQLite rolls back by itself on a full or failing disk; ThrowSqlite has logged the reason.
  }
}

void Database::Transaction::Commit() {
  connection_.Execute("COMMIT");
  is_open_ = false;
  if (has_folder_sync_failed) throw DiskFailure("the folder of the database was not synced");
}

void Database::Close::operator()(sqlite3* database) const { sqlite3_close_v2(database); }

Database::Database(const std::filesystem::path& file, DatabaseUse use) {
  WatchFolderSyncs();
  sqlite3* database = nullptr;
  int flags = SQLITE_OPEN_READONLY;
  if (use != DatabaseUse::kLook) flags = SQLITE_OPEN_READWRITE;
  if (use == DatabaseUse::kOwn) flags |= SQLITE_OPEN_CREATE;
  const int result =
      sqlite3_open_v2(file.c_str(), &database, flags | SQLITE_OPEN_FULLMUTEX, nullptr);
  database_.reset(database);
  CheckSqlite(database, result);
  sqlite3_extended_result_codes(database, 1);
  sqlite3_busy_timeout(database, 5000);

  Connection connection(database);
  if (use != DatabaseUse::kOwn) RequireSchema(connection);
  if (use == DatabaseUse::kLook) return;
  for (const char* pragma :
       {"PRAGMA journal_mode=WAL", "PRAGMA synchronous=FULL", "PRAGMA foreign_keys=ON",
        "PRAGMA trusted_schema=OFF", "PRAGMA journal_size_limit=67108864"})
    connection.Execute(pragma);
  // Our own checkpoints: the failure of SQLite's automatic ones is told to nobody.
  sqlite3_wal_hook(
      database,
      [](void* pages, sqlite3*, const char*, int count) {
        *static_cast<int*>(pages) = count;
        return SQLITE_OK;
      },
      &log_pages_);
  if (use == DatabaseUse::kShare) return;
  Statement check = connection.Query("PRAGMA quick_check(1)");
  const std::string finding = check.Step() ? check.Text(0) : "no answer";
  Require(finding == "ok", ErrorCode::kInternal,
          "the database is damaged (" + finding + "): restore it from a backup");
  Write([](Connection& writer) { MigrateSchema(writer); });
}

void Database::CheckpointIfLong() {
  if (log_pages_ < kLongLogPages) return;
  log_pages_ = 0;
  const int result = sqlite3_wal_checkpoint_v2(database_.get(), nullptr, SQLITE_CHECKPOINT_PASSIVE,
                                               nullptr, nullptr);
  // On a full disk, or while another program reads, the log grows on and is tried again later.
  if (result != SQLITE_BUSY && (result & 0xff) != SQLITE_FULL) CheckSqlite(database_.get(), result);
}

void Database::Freeze(const std::string& reason) {
  if (is_frozen_.exchange(true)) return;
  LogError("the disk failed, nothing is written any more reason=" + reason);
  // A checkpoint at the end might take what the disk lost for kept.
  sqlite3_db_config(database_.get(), SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
  if (on_freeze_) on_freeze_();
}

void Database::RequireWritable() const {
  if (is_frozen_)
    throw DiskFailure("the disk of the data directory failed: the service writes nothing more");
}

}  // namespace parkade
