#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <type_traits>

#include "server/store/disk/disk_failure.h"
#include "server/store/tables/connection.h"

struct sqlite3;

namespace parkade {

enum class DatabaseUse {
  kOwn,    ///< read and write, the only one to do so
  kShare,  ///< read and write a little, beside a service that runs
  kLook,   ///< read, beside a service that may run
};

/// The SQLite file that holds the truth about drives, jobs, rigs and maps:
/// write-ahead log, synchronous=FULL, foreign keys, STRICT tables. A Write that
/// returned has survived a power cut. Thread-safe; one caller at a time.
class Database {
 public:
  /// Opens or creates `file`, checks it, and brings its schema up to date; or only looks at one
  /// that may be in use. Throws Error{kInternal} when it is damaged, Error{kConflict} when a newer
  /// program wrote it, or an older one unless it is owned.
  explicit Database(const std::filesystem::path& file, DatabaseUse use = DatabaseUse::kOwn);

  /// Calls `body(Connection&)` and returns what it returns.
  template <typename Body>
  auto Read(const Body& body) {
    const std::lock_guard lock(mutex_);
    Connection connection(database_.get());
    return body(connection);
  }

  /// Does so inside one transaction: committed when `body` returns, undone when it throws. Throws
  /// DiskFailure when the disk did not keep it, which freezes the database: whether the
  /// transaction is there after the next start is not known then, so delete nothing it may need.
  template <typename Body>
  auto Write(const Body& body) {
    const std::lock_guard lock(mutex_);
    RequireWritable();
    try {
      return WriteLocked(body);
    } catch (const DiskFailure& failure) {
      Freeze(failure.what());
      throw;
    }
  }

  /// Lets nothing be written any more: every Write throws DiskFailure from now on. What calls it
  /// first is logged and told to the listener.
  void Freeze(const std::string& reason);
  bool is_frozen() const { return is_frozen_; }
  void RequireWritable() const;

  /// `listener` is called once, by the thread that met the failure: let it do little. Set it before
  /// there are other threads.
  void OnFreeze(std::function<void()> listener) { on_freeze_ = std::move(listener); }

 private:
  template <typename Body>
  auto WriteLocked(const Body& body) {
    Connection connection(database_.get());
    Transaction transaction(connection);
    if constexpr (std::is_void_v<std::invoke_result_t<Body, Connection&>>) {
      body(connection);
      transaction.Commit();
      CheckpointIfLong();
    } else {
      auto result = body(connection);
      transaction.Commit();
      CheckpointIfLong();
      return result;
    }
  }
  void CheckpointIfLong();

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
  int log_pages_ = 0;  ///< in the write-ahead log after the last commit
  std::atomic<bool> is_frozen_ = false;
  std::function<void()> on_freeze_;
};

}  // namespace parkade
