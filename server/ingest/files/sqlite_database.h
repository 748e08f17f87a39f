#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

struct sqlite3;
struct sqlite3_stmt;

namespace parkade {

/// One connection to a database that others gave us: read only, immutable, and distrusted.
/// Thread-compatible.
class SqliteDatabase {
 public:
  /// Throws Error{kInvalidInput}.
  explicit SqliteDatabase(const std::filesystem::path& file);

  sqlite3* get() const { return database_.get(); }

 private:
  struct Close {
    void operator()(sqlite3* database) const;
  };
  std::unique_ptr<sqlite3, Close> database_;
};

/// A query and its current row. Throws Error{kInvalidInput} with SQLite's words, even where the
/// database is damaged.
class SqliteQuery {
 public:
  SqliteQuery(const SqliteDatabase& database, const std::string& sql);

  bool Step();  ///< false: no more rows
  std::int64_t Integer(int column) const;
  std::string Text(int column) const;
  /// Throws when the bytes cannot be read. Valid until the next Step().
  std::pair<const std::uint8_t*, std::size_t> Blob(int column) const;

 private:
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const;
  };
  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
};

}  // namespace parkade
