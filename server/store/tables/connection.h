#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

struct sqlite3;
struct sqlite3_stmt;

namespace parkade {

/// One prepared statement with its parameters bound; walks over its rows.
/// Columns count from 0. Lives no longer than its Connection.
class Statement {
 public:
  Statement(sqlite3* database, std::string_view sql);

  void Bind(int parameter, std::int64_t value);
  void Bind(int parameter, double value);
  void Bind(int parameter, std::string_view value);
  void Bind(int parameter, std::nullopt_t);
  template <typename T>
  void Bind(int parameter, const std::optional<T>& value) {
    if (value) {
      Bind(parameter, *value);
    } else {
      Bind(parameter, std::nullopt);
    }
  }

  /// Moves to the next row; false after the last. Throws Error{kDiskFull} when
  /// the disk is full, Error{kInternal} otherwise.
  bool Step();

  std::string Text(int column) const;  ///< "" where NULL
  std::int64_t Integer(int column) const;
  bool IsNull(int column) const;

 private:
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const;
  };
  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
};

/// The one open connection. Only ever seen inside Database::Read and Write.
class Connection {
 public:
  explicit Connection(sqlite3* database) : database_(database) {}

  /// Parameters `?` are bound in order: integers, doubles, texts, optionals.
  template <typename... Values>
  Statement Query(std::string_view sql, const Values&... values) {
    Statement statement(database_, sql);
    int parameter = 0;
    (BindOne(statement, ++parameter, values), ...);
    return statement;
  }

  /// Runs to the end and returns how many rows it changed.
  template <typename... Values>
  int Execute(std::string_view sql, const Values&... values) {
    Statement statement = Query(sql, values...);
    while (statement.Step()) {
    }
    return Changes();
  }

 private:
  template <typename Value>
  static void BindOne(Statement& statement, int parameter, const Value& value) {
    if constexpr (std::is_integral_v<Value>) {
      statement.Bind(parameter, static_cast<std::int64_t>(value));
    } else {
      statement.Bind(parameter, value);
    }
  }

  int Changes() const;

  sqlite3* database_;
};

/// Throws Error{kDiskFull} or Error{kInternal}, and logs the reason, unless `result` is SQLITE_OK.
void CheckSqlite(sqlite3* database, int result);

}  // namespace parkade
