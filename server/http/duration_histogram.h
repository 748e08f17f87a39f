#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>

namespace parkade {

/// Counts durations by their size, as Prometheus wants them. Thread-safe.
class DurationHistogram {
 public:
  /// [s] upper bounds of all buckets but the last, which has none.
  static constexpr std::array kBounds = {0.001, 0.005, 0.02, 0.1, 0.5, 1.0, 5.0, 30.0, 300.0};

  void Add(std::chrono::steady_clock::duration duration) {
    const double seconds = std::chrono::duration<double>(duration).count();
    size_t bucket = 0;
    while (bucket < kBounds.size() && seconds > kBounds[bucket]) ++bucket;
    ++counts_[bucket];
    microseconds_ += std::chrono::duration_cast<std::chrono::microseconds>(duration).count();
  }

  /// How many fell into a bucket, without those of smaller ones; `bucket` <= kBounds.size().
  std::int64_t count(size_t bucket) const { return counts_[bucket]; }
  /// [s] of all together.
  double sum() const { return 1e-6 * static_cast<double>(microseconds_); }

 private:
  std::array<std::atomic<std::int64_t>, kBounds.size() + 1> counts_{};
  std::atomic<std::int64_t> microseconds_{0};
};

}  // namespace parkade
