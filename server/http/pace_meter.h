#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <optional>

namespace parkade {

/// Measures how fast a client sends or reads. Only the time counts in which the service has nothing
/// to do but wait for it, so that a slow disk is not taken for a slow client. Thread-safe.
class PaceMeter {
 public:
  using Clock = std::chrono::steady_clock;

  /// What every client must reach while it is waited for.
  static constexpr double kLeastPace = 8192;  // [bytes/s]
  /// How long it may stay below, in all and where others wait for its place.
  static constexpr std::chrono::seconds kGrace{10};
  static constexpr std::chrono::seconds kGraceUnderPressure{2};

  /// Begins anew, with a new request.
  void Reset();
  void BeginWaiting(Clock::time_point now);
  void EndWaiting(Clock::time_point now);
  /// Takes note of bytes that went to or came from the client.
  void Count(std::int64_t bytes);

  /// [bytes/s] over the last `span` of waiting (whole seconds, at most kGrace); nothing where it
  /// was not waited for as long.
  std::optional<double> PaceOver(std::chrono::seconds span, Clock::time_point now) const;

  bool IsTooSlow(Clock::time_point now) const {
    return PaceOver(kGrace, now).value_or(kLeastPace) < kLeastPace;
  }

 private:
  static constexpr size_t kNumBuckets = 11;  // a whole span, and the second that runs

  /// Time waited until now; opens the buckets up to it.
  Clock::duration Advance(Clock::time_point now) const;

  mutable std::mutex mutex_;
  Clock::duration waited_{};
  std::optional<Clock::time_point> wait_began_;
  mutable std::array<std::int64_t, kNumBuckets> bytes_{};  ///< by second of waiting, in a ring
  mutable std::int64_t second_ = 0;                        ///< whose bucket is filled
};

}  // namespace parkade
