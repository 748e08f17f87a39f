#pragma once

#include <httplib.h>

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace parkade {

/// A fixed number of threads, each serving one connection at a time, and a short
/// queue before them. When that is full, a connection is handed to its function
/// at once with is_refusing() true, for a quick 503.
class ConnectionQueue : public httplib::TaskQueue {
 public:
  ConnectionQueue(int num_threads, size_t max_waiting);
  ~ConnectionQueue() override;

  void enqueue(std::function<void()> serve) override;
  void shutdown() override;

  /// True inside a function that must refuse its connection.
  static bool is_refusing();

 private:
  void Work();

  const size_t max_waiting_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> waiting_;
  bool is_stopping_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace parkade
