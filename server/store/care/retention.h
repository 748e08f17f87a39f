#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "server/store/store.h"

namespace parkade {

/// What was deleted because its time was over.
struct Expired {
  std::vector<std::string> drives;                         ///< ids: their logs
  std::vector<std::pair<std::string, std::int64_t>> maps;  ///< site and version: their files
};

/// Deletes what every site keeps no longer at `now`: logs of drives that came more than its
/// `log_days` before, but not while a job needs them, and the files of versions that were made
/// more than its `map_days` before, but never the newest, an approved one, one that a job starts
/// from or any while a job of the site runs. The rows stay and say so. Files are gone from the
/// disk when it returns; equal logs of drives that keep theirs stay. Drops stale work of jobs, too
/// (job_work.h). Throws Error{kDiskFull},
/// DiskFailure.
Expired DeleteExpired(Store& store, std::chrono::system_clock::time_point now);

/// Does so in a thread of its own, at the start and every `interval`.
class RetentionKeeper {
 public:
  using Clock = std::function<std::chrono::system_clock::time_point()>;
  using Listener = std::function<void(const Expired&)>;

  /// Borrows the store. `listener` is told of what was deleted, from the thread.
  RetentionKeeper(Store& store, std::chrono::milliseconds interval, Listener listener,
                  Clock clock = std::chrono::system_clock::now);
  ~RetentionKeeper();
  RetentionKeeper(const RetentionKeeper&) = delete;
  RetentionKeeper& operator=(const RetentionKeeper&) = delete;

 private:
  void Work(std::chrono::milliseconds interval);

  Store& store_;
  const Listener listener_;
  const Clock clock_;
  std::mutex mutex_;
  std::condition_variable stopping_;
  bool is_stopping_ = false;
  std::thread thread_;
};

}  // namespace parkade
