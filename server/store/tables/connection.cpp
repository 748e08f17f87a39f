#include "server/store/tables/connection.h"

#include <sqlite3.h>

#include "core/error.h"
#include "core/log.h"
#include "server/store/disk/disk_failure.h"

namespace parkade {
namespace {

[[noreturn]] void ThrowSqlite(sqlite3* database, int result) {
  const std::string reason =
      database != nullptr ? sqlite3_errmsg(database) : sqlite3_errstr(result);
  LogError("database code=" + std::to_string(result) + " reason=" + reason);
  if ((result & 0xff) == SQLITE_FULL)
    throw Error(ErrorCode::kDiskFull, "the disk of the data directory is full");
  if ((result & 0xff) == SQLITE_IOERR) throw DiskFailure("the database failed: " + reason);
  throw Error(ErrorCode::kInternal, "the database failed: " + reason);
}

}  // namespace

void Statement::Finalize::operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }

Statement::Statement(sqlite3* database, std::string_view sql) {
  sqlite3_stmt* statement = nullptr;
  const int result =
      sqlite3_prepare_v2(database, sql.data(), static_cast<int>(sql.size()), &statement, nullptr);
  statement_.reset(statement);
  CheckSqlite(database, result);
}

void Statement::Bind(int parameter, std::int64_t value) {
  CheckSqlite(sqlite3_db_handle(statement_.get()),
              sqlite3_bind_int64(statement_.get(), parameter, value));
}

void Statement::Bind(int parameter, double value) {
  CheckSqlite(sqlite3_db_handle(statement_.get()),
              sqlite3_bind_double(statement_.get(), parameter, value));
}

void Statement::Bind(int parameter, std::string_view value) {
  // An empty view may have no data at all, which SQLite would take for NULL.
  const char* text = value.empty() ? "" : value.data();
  CheckSqlite(sqlite3_db_handle(statement_.get()),
              sqlite3_bind_text64(statement_.get(), parameter, text, value.size(), SQLITE_TRANSIENT,
                                  SQLITE_UTF8));
}

void Statement::Bind(int parameter, std::nullopt_t) {
  CheckSqlite(sqlite3_db_handle(statement_.get()), sqlite3_bind_null(statement_.get(), parameter));
}

bool Statement::Step() {
  const int result = sqlite3_step(statement_.get());
  if (result == SQLITE_ROW) return true;
  if (result != SQLITE_DONE) ThrowSqlite(sqlite3_db_handle(statement_.get()), result);
  return false;
}

std::string Statement::Text(int column) const {
  const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement_.get(), column));
  if (text == nullptr) return "";
  return {text, static_cast<size_t>(sqlite3_column_bytes(statement_.get(), column))};
}

std::int64_t Statement::Integer(int column) const {
  return sqlite3_column_int64(statement_.get(), column);
}

bool Statement::IsNull(int column) const {
  return sqlite3_column_type(statement_.get(), column) == SQLITE_NULL;
}

int Connection::Changes() const { return sqlite3_changes(database_); }

void CheckSqlite(sqlite3* database, int result) {
  if (result != SQLITE_OK) ThrowSqlite(database, result);
}

}  // namespace parkade
