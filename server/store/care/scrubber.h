#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>

#include "server/store/care/stored_files.h"

namespace parkade {

/// Looks after stored files in a thread of its own, which gives way to everything else: at the
/// start it looks whether all are there, and from then on it reads each once per `interval`,
/// whichever was read longest ago first. What is damaged is logged and noted in the database.
class Scrubber {
 public:
  /// Borrows the store. An interval of 0 only looks whether all are there.
  Scrubber(Store& store, std::chrono::milliseconds interval);
  ~Scrubber();
  Scrubber(const Scrubber&) = delete;
  Scrubber& operator=(const Scrubber&) = delete;

 private:
  void Work(std::chrono::milliseconds interval);
  void LookAtAll();
  void ReadDue(std::chrono::milliseconds interval);
  bool Rest(std::chrono::milliseconds time);

  Store& store_;
  std::mutex mutex_;
  std::condition_variable stopping_;
  bool is_stopping_ = false;
  std::thread thread_;
};

}  // namespace parkade
