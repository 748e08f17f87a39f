#include "server/ingest/files/merge_wal.h"

#include <sqlite3.h>

#include <cerrno>
#include <memory>
#include <system_error>

#include "core/error.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

fs::path WalOf(const fs::path& database) { return database.string() + "-wal"; }

void Copy(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::copy_file(from, to, error);
  const std::string name = "'" + from.filename().string() + "'";
  const bool is_full = error == std::errc::no_space_on_device ||
                       error == std::error_code(EDQUOT, std::system_category());
  Require(!is_full, ErrorCode::kDiskFull,
          "there is no space to copy " + name + ", which is read together with its -wal file");
  Require(!error, ErrorCode::kInvalidInput, "cannot copy " + name + ": " + error.message());
  fs::permissions(to, fs::perms::owner_read | fs::perms::owner_write);
}

struct Close {
  void operator()(sqlite3* database) const { sqlite3_close_v2(database); }
};

/// The number of pages that the log of a database holds, once all are in the database itself; -1
/// where there is no log that SQLite can use.
int TakeInWal(const fs::path& file) {
  sqlite3* opened = nullptr;
  const int result =
      sqlite3_open_v2(file.c_str(), &opened, SQLITE_OPEN_READWRITE | SQLITE_OPEN_NOMUTEX, nullptr);
  const std::unique_ptr<sqlite3, Close> database(opened);
  if (result != SQLITE_OK) return -1;
  sqlite3_db_config(opened, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_db_config(opened, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  // In exclusive mode the index of the log stays in memory. The log is found by the first query.
  sqlite3_exec(opened,
               "PRAGMA locking_mode = EXCLUSIVE; PRAGMA synchronous = OFF;"
               "SELECT count(*) FROM sqlite_master",
               nullptr, nullptr, nullptr);
  int num_pages = -1, num_taken = -1;
  const int taken =
      sqlite3_wal_checkpoint_v2(opened, nullptr, SQLITE_CHECKPOINT_FULL, &num_pages, &num_taken);
  Require(taken != SQLITE_FULL, ErrorCode::kDiskFull,
          "there is no space to read '" + file.filename().string() + "' with its -wal file");
  return taken == SQLITE_OK && num_taken == num_pages ? num_pages : -1;
}

}  // namespace

bool HasWal(const fs::path& database) {
  constexpr std::uintmax_t kHeaderSize = 32;
  std::error_code error;
  const std::uintmax_t size = fs::file_size(WalOf(database), error);
  return !error && size > kHeaderSize;
}

std::string NameOfWal(const fs::path& database) { return WalOf(database).filename().string(); }

bool MergeWal(const fs::path& database, const fs::path& copy) {
  Copy(database, copy);
  Copy(WalOf(database), WalOf(copy));
  const int num_pages = TakeInWal(copy);
  std::error_code ignored;  // SQLite has removed it unless it is damaged
  fs::remove(WalOf(copy), ignored);
  return num_pages > 0;
}

}  // namespace parkade
