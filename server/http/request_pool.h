#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "server/http/connection.h"

namespace parkade {

/// What is done with a connection whose request has a thread.
struct PoolHooks {
  std::function<void(HttpConnection&)> answer;
  std::function<void(std::unique_ptr<HttpConnection>)> leave;  ///< after the answer
};

/// The threads that answer one class of requests, at most a fixed number, and a bounded queue
/// before them. Threads start when they are first needed.
class RequestPool {
 public:
  /// `hooks` and `metrics` outlive the pool.
  RequestPool(size_t max_threads, size_t max_waiting, const PoolHooks& hooks,
              RouteClassMetrics& metrics);
  ~RequestPool() { Join(); }
  RequestPool(const RequestPool&) = delete;
  RequestPool& operator=(const RequestPool&) = delete;

  /// Takes the connection over, to answer its request. False when the pool is full: then nothing
  /// has happened.
  bool Submit(std::unique_ptr<HttpConnection>& connection);

  /// Where requests wait, cuts as many clients off that are below the least pace, the slowest
  /// first. To be called every now and then.
  void Relieve(HttpConnection::Clock::time_point now);

  /// True while nothing is answered or waits.
  bool IsIdle() const;

  /// Answers what waits and ends the threads.
  void Join();

 private:
  void Work();

  const size_t max_threads_, max_waiting_;
  const PoolHooks& hooks_;
  RouteClassMetrics& metrics_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::unique_ptr<HttpConnection>> waiting_;
  std::vector<HttpConnection*> answered_;  ///< by some thread now
  size_t num_busy_ = 0;
  bool is_stopping_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace parkade
