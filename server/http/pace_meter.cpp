#include "server/http/pace_meter.h"

#include <algorithm>

namespace parkade {

void PaceMeter::Reset() {
  const std::lock_guard lock(mutex_);
  waited_ = {};
  wait_began_.reset();
  bytes_.fill(0);
  second_ = 0;
}

void PaceMeter::BeginWaiting(Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  wait_began_ = now;
}

void PaceMeter::EndWaiting(Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  waited_ = Advance(now);
  wait_began_.reset();
}

void PaceMeter::Count(std::int64_t bytes) {
  const std::lock_guard lock(mutex_);
  bytes_[static_cast<size_t>(second_) % kNumBuckets] += bytes;
}

std::optional<double> PaceMeter::PaceOver(std::chrono::seconds span, Clock::time_point now) const {
  const std::lock_guard lock(mutex_);
  const Clock::duration waited = Advance(now);
  if (waited < span) return std::nullopt;
  // The last whole seconds and what has passed of this one.
  const std::int64_t begin = std::max<std::int64_t>(second_ - span.count(), 0);
  std::int64_t bytes = 0;
  for (std::int64_t second = begin; second <= second_; ++second)
    bytes += bytes_[static_cast<size_t>(second) % kNumBuckets];
  const double seconds =
      std::chrono::duration<double>(waited - std::chrono::seconds(begin)).count();
  return static_cast<double>(bytes) / seconds;
}

PaceMeter::Clock::duration PaceMeter::Advance(Clock::time_point now) const {
  const Clock::duration waited = waited_ + (wait_began_ ? now - *wait_began_ : Clock::duration{});
  const std::int64_t second = std::chrono::duration_cast<std::chrono::seconds>(waited).count();
  second_ = std::max(second_, second - static_cast<std::int64_t>(kNumBuckets));
  while (second_ < second) bytes_[static_cast<size_t>(++second_) % kNumBuckets] = 0;
  return waited;
}

}  // namespace parkade
