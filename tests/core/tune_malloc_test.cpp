#include "core/tune_malloc.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
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

constexpr const char* kTunables = "GLIBC_TUNABLES";
constexpr int kReturned = 77;

/// The status with which this program ends when a child asks for huge pages, its tunables being
/// those given; kReturned where it was not started again.
int StatusWithTunables(const char* tunables) {
  std::array<char*, 4> arguments{const_cast<char*>("parkade_core_tests"),
                                 const_cast<char*>("--gtest_filter=*StartedAgain"),
                                 const_cast<char*>("--gtest_also_run_disabled_tests"), nullptr};
  const pid_t child = ::fork();
  if (child == 0) {
    ::setenv(kTunables, tunables, 1);
    UseHugePages(arguments.data());
    ::_exit(kReturned);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WEXITSTATUS(status);
}

TEST(UseHugePages, DISABLED_StartedAgain) {
  EXPECT_STREQ(std::getenv(kTunables), "glibc.malloc.top_pad=131072:glibc.malloc.hugetlb=1");
}

TEST(UseHugePages, TheProgramStartsAgainAndKeepsOtherTunables) {
  const int status = StatusWithTunables("glibc.malloc.top_pad=131072");
  if (status == kReturned) GTEST_SKIP() << "the system does not give huge pages to who asks";
  EXPECT_EQ(status, 0);
}

TEST(UseHugePages, OneThatHasSaidSoIsNotStartedAgain) {
  EXPECT_EQ(StatusWithTunables("glibc.malloc.hugetlb=0"), kReturned);
}

}  // namespace
}  // namespace parkade
