#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
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
  double Real(int column) const;
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

/// The SQLite file that holds the truth about drives, jobs, rigs and maps:
/// write-ahead log, synchronous=FULL, foreign keys, STRICT tables. A Write that
/// returned has survived a power cut. Thread-safe; one caller at a time.
class Database {
 public:
  /// Opens or creates `file`, checks it, and brings its schema up to date.
  /// Throws Error{kInternal} when it is damaged, Error{kConflict} when a newer
  /// program wrote it.
  explicit Database(const std::filesystem::path& file);

  /// Calls `body(Connection&)` and returns what it returns.
  template <typename Body>
  auto Read(const Body& body) {
    const std::lock_guard lock(mutex_);
    Connection connection(database_.get());
    return body(connection);
  }

  /// The same inside one transaction: committed when `body` returns, undone
  /// when it throws.
  template <typename Body>
  auto Write(const Body& body) {
    const std::lock_guard lock(mutex_);
    Connection connection(database_.get());
    Transaction transaction(connection);
    if constexpr (std::is_void_v<std::invoke_result_t<Body, Connection&>>) {
      body(connection);
      transaction.Commit();
    } else {
      auto result = body(connection);
      transaction.Commit();
      return result;
    }
  }

 private:
  class Transaction {
   public:
    explicit Transaction(Connection& connection);
    ~Transaction();
    Transaction(const Transaction&) = delete;
    Transaction& operator=(const Transaction&) = delete;
    void Commit();

   private:
    Connection& connection_;
    bool is_open_ = true;
  };
  struct Close {
    void operator()(sqlite3* database) const;
  };

  std::unique_ptr<sqlite3, Close> database_;
  std::mutex mutex_;
};

}  // namespace parkade
