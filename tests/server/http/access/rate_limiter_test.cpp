#include "server/http/access/rate_limiter.h"

#include <gtest/gtest.h>

namespace parkade {
namespace {

using namespace std::chrono_literals;

TEST(RateLimiter, AdmitsABurstAndThenAPace) {
  RateLimiter limiter(0.5, 3);
  const RateLimiter::Clock::time_point start{};
  for (int i = 0; i < 3; ++i) EXPECT_EQ(limiter.Take("anne", start), 0);
  EXPECT_EQ(limiter.Take("anne", start), 2);
  EXPECT_EQ(limiter.Take("anne", start + 1s), 1) << "half of one has come back";
  EXPECT_EQ(limiter.Take("anne", start + 2s), 0);
  EXPECT_EQ(limiter.Take("anne", start + 2s), 2);
  EXPECT_EQ(limiter.Take("bert", start + 2s), 0) << "each has its own";
  for (int i = 0; i < 3; ++i) EXPECT_EQ(limiter.Take("anne", start + 1h), 0);
  EXPECT_GT(limiter.Take("anne", start + 1h), 0) << "no more than a burst is saved up";
}

TEST(RateLimiter, StrangersDoNotMakeItGrow) {
  RateLimiter limiter(1, 2);
  const RateLimiter::Clock::time_point start{};
  for (int i = 0; i < 200'000; ++i) limiter.Take(std::to_string(i), start);
  EXPECT_EQ(limiter.Take("anne", start), 0);
  EXPECT_EQ(limiter.Take("anne", start), 0);
  EXPECT_GT(limiter.Take("anne", start), 0);
}

}  // namespace
}  // namespace parkade
