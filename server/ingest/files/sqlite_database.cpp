#include "server/ingest/files/sqlite_database.h"

#include <sqlite3.h>

#include "core/error.h"

namespace parkade {
namespace {

std::string UriOf(const std::filesystem::path& file) {
  static constexpr char kDigits[] = "0123456789ABCDEF";
  std::string uri = "file:";
  for (const char c : std::filesystem::absolute(file).string()) {
    if (c == '/' || c == '-' || c == '_' || c == '.' || (c > 0 && std::isalnum(c))) {
      uri += c;
    } else {
      const auto byte = static_cast<unsigned char>(c);
      uri += {'%', kDigits[byte >> 4], kDigits[byte & 15]};
    }
  }
  return uri + "?mode=ro&immutable=1";
}

[[noreturn]] void ThrowLastError(sqlite3* database) {
  throw Error(ErrorCode::kInvalidInput,
              "the database cannot be read: " + std::string(sqlite3_errmsg(database)));
}

}  // namespace

SqliteDatabase::SqliteDatabase(const std::filesystem::path& file) {
  sqlite3* database = nullptr;
  constexpr int kFlags = SQLITE_OPEN_READONLY | SQLITE_OPEN_URI | SQLITE_OPEN_NOMUTEX;
  const int result = sqlite3_open_v2(UriOf(file).c_str(), &database, kFlags, nullptr);
  database_.reset(database);
  if (result != SQLITE_OK) ThrowLastError(database);
  sqlite3_db_config(database, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_db_config(database, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  sqlite3_exec(database,
               "PRAGMA cell_size_check = ON; PRAGMA mmap_size = 0; PRAGMA cache_size = -4096",
               nullptr, nullptr, nullptr);
}

void SqliteDatabase::Close::operator()(sqlite3* database) const { sqlite3_close_v2(database); }

SqliteQuery::SqliteQuery(const SqliteDatabase& database, const std::string& sql) {
  sqlite3_stmt* statement = nullptr;
  if (sqlite3_prepare_v2(database.get(), sql.c_str(), -1, &statement, nullptr) != SQLITE_OK)
    ThrowLastError(database.get());
  statement_.reset(statement);
}

void SqliteQuery::Finalize::operator()(sqlite3_stmt* statement) const {
  sqlite3_finalize(statement);
}

bool SqliteQuery::Step() {
  const int result = sqlite3_step(statement_.get());
  if (result != SQLITE_ROW && result != SQLITE_DONE)
    ThrowLastError(sqlite3_db_handle(statement_.get()));
  return result == SQLITE_ROW;
}

std::int64_t SqliteQuery::Integer(int column) const {
  return sqlite3_column_int64(statement_.get(), column);
}

std::string SqliteQuery::Text(int column) const {
  const unsigned char* text = sqlite3_column_text(statement_.get(), column);
  return text == nullptr ? "" : reinterpret_cast<const char*>(text);
}

std::pair<const std::uint8_t*, std::size_t> SqliteQuery::Blob(int column) const {
  const void* bytes = sqlite3_column_blob(statement_.get(), column);
  sqlite3* database = sqlite3_db_handle(statement_.get());
  const int error = sqlite3_errcode(database);
  if (bytes == nullptr && error != SQLITE_OK && error != SQLITE_ROW) ThrowLastError(database);
  return {static_cast<const std::uint8_t*>(bytes),
          static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column))};
}

}  // namespace parkade
