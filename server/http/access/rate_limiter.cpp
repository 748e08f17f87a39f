#include "server/http/access/rate_limiter.h"

#include <algorithm>
#include <cmath>

namespace parkade {
namespace {

constexpr size_t kMaxBuckets = 65536;

}  // namespace

double RateLimiter::LeftIn(const Bucket& bucket, Clock::time_point now) const {
  const double seconds = std::chrono::duration<double>(now - bucket.filled_at).count();
  return std::min(burst_, bucket.left + seconds * per_second_);
}

int RateLimiter::Take(const std::string& who, Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  if (buckets_.size() >= kMaxBuckets && !buckets_.contains(who)) ForgetRested(now);
  Bucket& bucket = buckets_.try_emplace(who, Bucket{burst_, now}).first->second;
  bucket = {LeftIn(bucket, now), now};
  if (bucket.left < 1) return static_cast<int>(std::ceil((1 - bucket.left) / per_second_));
  bucket.left -= 1;
  return 0;
}

void RateLimiter::ForgetRested(Clock::time_point now) {
  std::erase_if(buckets_, [&](const auto& bucket) { return LeftIn(bucket.second, now) >= burst_; });
  // So many at once: start anew, rather than grow.
  if (buckets_.size() >= kMaxBuckets) buckets_.clear();
}

}  // namespace parkade
