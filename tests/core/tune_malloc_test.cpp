#include "core/tune_malloc.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <memory>
#include <vector>

#include "tests/support/sanitizers.h"

namespace parkade {
namespace {

long PageFaults() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return usage.ru_minflt;
}

TEST(KeepMemory, APieceThatWasLetGoIsTakenAgainWithoutNewPages) {
  if (kHasSanitizer) GTEST_SKIP() << "sanitizers have an allocator of their own";
  constexpr std::size_t kSize = 16 << 20;
  constexpr int kPages = kSize / 4096;
  TuneMalloc();
  { const std::vector<char> first(kSize, 1); }
  const long before = PageFaults();
  for (int i = 0; i < 5; ++i) const std::vector<char> again(kSize, 2);
  EXPECT_LT(PageFaults() - before, kPages);
}

TEST(ReleaseIdleMemory, WhatIsLetGoBelowWhatIsHeldNeedsNewPages) {
  if (kHasSanitizer) GTEST_SKIP() << "sanitizers have an allocator of their own";
  constexpr std::size_t kSize = 16 << 20;
  constexpr int kPages = kSize / 4096;
  TuneMalloc();
  auto idle = std::make_unique<std::vector<char>>(kSize, 1);
  const std::vector<char> held(kSize, 1);
  idle.reset();

  ReleaseIdleMemory();

  const long before = PageFaults();
  const std::vector<char> again(kSize, 2);
  EXPECT_GE(PageFaults() - before, kPages / 2);
}

}  // namespace
}  // namespace parkade
