#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>

namespace parkade {

/// Counters of the HTTP side since the start. Thread-safe.
struct Metrics {
  std::array<std::atomic<std::int64_t>, 6> answers_by_class{};  ///< [2] counts 2xx, ...
  std::atomic<std::int64_t> requests_refused{0};     ///< whose heads the library never saw
  std::atomic<std::int64_t> connections_refused{0};  ///< for want of threads
  std::atomic<std::int64_t> connections{0};          ///< open now
  std::atomic<std::int64_t> event_clients{0};        ///< open now
  std::atomic<std::int64_t> upload_bytes{0};
  const std::chrono::steady_clock::time_point started = std::chrono::steady_clock::now();
};

/// Counts one up as long as it lives.
class CountedPresence {
 public:
  explicit CountedPresence(std::atomic<std::int64_t>& count) : count_(count) { ++count_; }
  ~CountedPresence() { --count_; }
  CountedPresence(const CountedPresence&) = delete;
  CountedPresence& operator=(const CountedPresence&) = delete;

 private:
  std::atomic<std::int64_t>& count_;
};

}  // namespace parkade
