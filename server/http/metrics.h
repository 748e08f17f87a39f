#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>

#include "server/http/duration_histogram.h"
#include "server/http/route_class.h"

namespace parkade {

/// Counters of the requests of one class.
struct RouteClassMetrics {
  std::atomic<std::int64_t> busy{0};     ///< threads with a request now
  std::atomic<std::int64_t> waiting{0};  ///< requests without a thread now
  std::atomic<std::int64_t> refused{0};  ///< since all threads and places to wait were taken
  DurationHistogram durations;           ///< from the whole request to the whole answer
};

/// Counters of the HTTP side since the start. Thread-safe.
struct Metrics {
  RouteClassMetrics& of(RouteClass route_class) {
    return classes[static_cast<size_t>(route_class)];
  }

  std::array<std::atomic<std::int64_t>, 6> answers_by_class{};  ///< [2] counts 2xx, ...
  std::array<RouteClassMetrics, kRouteClasses.size()> classes;
  std::atomic<std::int64_t> requests_refused{0};     ///< whose heads the library never saw
  std::atomic<std::int64_t> connections_refused{0};  ///< for want of places in the lobby
  std::atomic<std::int64_t> connections_too_slow{0};
  std::atomic<std::int64_t> connections{0};          ///< open now
  std::atomic<std::int64_t> connections_waiting{0};  ///< in the lobby now
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
