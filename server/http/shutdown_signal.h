#pragma once

#include <atomic>
#include <chrono>

namespace parkade {

/// Tells connections when the service ends. Thread-safe.
class ShutdownSignal {
 public:
  /// Begins the end: no request is begun any more, and after `patience` none goes on.
  void Cut(std::chrono::milliseconds patience) {
    end_ = (std::chrono::steady_clock::now() + patience).time_since_epoch().count();
  }

  bool is_stopping() const { return end_ != kNever; }
  bool is_over() const {
    return is_stopping() && std::chrono::steady_clock::now().time_since_epoch().count() >= end_;
  }

 private:
  using Ticks = std::chrono::steady_clock::rep;
  static constexpr Ticks kNever = -1;
  std::atomic<Ticks> end_{kNever};
};

}  // namespace parkade
