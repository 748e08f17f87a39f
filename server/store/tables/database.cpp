#include "server/store/tables/database.h"

#include <sqlite3.h>

#include "core/error.h"
#include "server/store/tables/schema.h"

namespace parkade {

Database::Transaction::Transaction(Connection& connection) : connection_(connection) {
  connection_.Execute("BEGIN IMMEDIATE");
}

Database::Transaction::~Transaction() {
  if (!is_open_) return;
  try {
    connection_.Execute("ROLLBACK");
  } catch (const Error&) {
    // SQLite rolls back by itself on a full disk; ThrowSqlite has logged the reason.
  }
}

void Database::Transaction::Commit() {
  connection_.Execute("COMMIT");
  is_open_ = false;
}

void Database::Close::operator()(sqlite3* database) const { sqlite3_close_v2(database); }

Database::Database(const std::filesystem::path& file) {
  sqlite3* database = nullptr;
  constexpr int kFlags = SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_FULLMUTEX;
  const int result = sqlite3_open_v2(file.c_str(), &database, kFlags, nullptr);
  database_.reset(database);
  CheckSqlite(database, result);
  sqlite3_extended_result_codes(database, 1);
  sqlite3_busy_timeout(database, 5000);

  Connection connection(database);
  for (const char* pragma :
       {"PRAGMA journal_mode=WAL", "PRAGMA synchronous=FULL", "PRAGMA foreign_keys=ON",
        "PRAGMA trusted_schema=OFF", "PRAGMA journal_size_limit=67108864"})
    connection.Execute(pragma);
  Statement check = connection.Query("PRAGMA quick_check(1)");
  const std::string finding = check.Step() ? check.Text(0) : "no answer";
  Require(finding == "ok", ErrorCode::kInternal,
          "the database is damaged (" + finding + "): restore it from a backup");
  Write([](Connection& writer) { MigrateSchema(writer); });
}

}  // namespace parkade
