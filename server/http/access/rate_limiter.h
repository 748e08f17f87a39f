#pragma once

#include <chrono>
#include <map>
#include <mutex>
#include <string>

namespace parkade {

/// How often each of many may do something: `burst` times at once, and `per_second` in the long
/// run (a token bucket each). Remembers a bounded number of them. Thread-safe.
class RateLimiter {
 public:
  using Clock = std::chrono::steady_clock;

  RateLimiter(double per_second, double burst) : per_second_(per_second), burst_(burst) {}

  /// Counts one. Returns 0 when `who` may, else the time [s] to wait, rounded up; that one is not
  /// counted.
  int Take(const std::string& who, Clock::time_point now);

 private:
  struct Bucket {
    double left = 0;
    Clock::time_point filled_at;
  };

  double LeftIn(const Bucket& bucket, Clock::time_point now) const;
  /// Forgets those who could do all at once again.
  void ForgetRested(Clock::time_point now);

  const double per_second_, burst_;
  std::mutex mutex_;
  std::map<std::string, Bucket> buckets_;
};

}  // namespace parkade
