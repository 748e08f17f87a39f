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

/// How many requests of one class are here at a time.
struct PoolSize {
  size_t num_threads = 0, num_places = 0;                      ///< answered, and waiting
  size_t num_threads_for_known = 0, num_places_for_known = 0;  ///< of these, never a stranger's
};

/// The threads that answer one class of requests, and a bounded queue before them. Requests of
/// those who are known (HttpConnection::is_known) go first, and have threads and places that
/// strangers never take. Threads start when they are first needed.
class RequestPool {
 public:
  /// `hooks` and `metrics` outlive the pool.
  RequestPool(const PoolSize& size, const PoolHooks& hooks, RouteClassMetrics& metrics);
  ~RequestPool() { Join(); }
  RequestPool(const RequestPool&) = delete;
  RequestPool& operator=(const RequestPool&) = delete;

  /// Takes the connection over, to answer its request. False when the pool is full: then nothing
  /// has happened.
  bool Submit(std::unique_ptr<HttpConnection>& connection);

  /// Where requests wait for a thread, cuts as many clients off that are below the least pace:
  /// strangers first, and the slowest first. To be called every now and then.
  void Relieve(HttpConnection::Clock::time_point now);

  /// True while nothing is answered or waits.
  bool IsIdle() const;

  /// Answers what waits and ends the threads.
  void Join();

 private:
  using Queue = std::deque<std::unique_ptr<HttpConnection>>;

  void Work();
  /// Whether a stranger may have a thread besides those who have one.
  bool HasThreadForStranger() const;
  /// The queue whose first request may have a thread now; null where none may.
  Queue* NextQueue();
  size_t num_waiting() const { return known_.size() + strangers_.size(); }

  const PoolSize size_;
  const PoolHooks& hooks_;
  RouteClassMetrics& metrics_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  Queue known_, strangers_;                ///< waiting
  std::vector<HttpConnection*> answered_;  ///< by some thread now
  size_t num_busy_ = 0, num_busy_strangers_ = 0;
  bool is_stopping_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace parkade
