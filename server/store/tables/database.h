#pragma once

#include <filesystem>
#include <memory>
#include <mutex>
#include <type_traits>

#include "server/store/tables/connection.h"

struct sqlite3;

namespace parkade {

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

  /// Does so inside one transaction: committed when `body` returns, undone when it throws.
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
