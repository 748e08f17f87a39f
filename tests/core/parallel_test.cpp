#include "core/parallel.h"

#include <dlfcn.h>
#include <gtest/gtest.h>

#include <atomic>
#include <numeric>
#include <stdexcept>

namespace parkade {
namespace {

// The pool is made once per process, so every test of this file asks for the same number.
class Parallel : public testing::Test {
 protected:
  Parallel() { SetNumThreads(4); }
};

TEST_F(Parallel, EveryIndexIsVisitedOnce) {
  std::vector<std::atomic<int>> visits(10'000);
  ParallelFor(visits.size(), [&](size_t i) { ++visits[i]; });
  for (const auto& count : visits) EXPECT_EQ(count, 1);
}

TEST_F(Parallel, ResultsComeInIndexOrder) {
  const std::vector<size_t> squares = ParallelMap(1000, [](size_t i) { return i * i; });
  for (size_t i = 0; i < squares.size(); ++i) EXPECT_EQ(squares[i], i * i);
}

TEST_F(Parallel, TheLowestFailingIndexIsReported) {
  for (int trial = 0; trial < 20; ++trial) {
    std::atomic<int> num_done{0};
    try {
      ParallelFor(200, [&](size_t i) {
        if (i % 50 == 17) throw std::runtime_error(std::to_string(i));
        ++num_done;
      });
      FAIL() << "nothing was thrown";
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "17");
    }
    EXPECT_EQ(num_done, 196);  // a failure does not stop the others
  }
}

TEST_F(Parallel, ALoopInsideALoopIsSafe) {
  std::atomic<int> count{0};
  ParallelFor(8, [&](size_t) { ParallelFor(8, [&](size_t) { ++count; }); });
  EXPECT_EQ(count, 64);
}

TEST_F(Parallel, ManySmallLoopsFollowEachOther) {
  int sum = 0;
  for (int i = 0; i < 2000; ++i) {
    const std::vector<int> ones = ParallelMap(3, [](size_t) { return 1; });
    sum += std::accumulate(ones.begin(), ones.end(), 0);
  }
  EXPECT_EQ(sum, 6000);
}

TEST_F(Parallel, LinearAlgebraTakesNoThreadsOfItsOwn) {
  using GetThreads = int (*)();
  void* get_threads = dlsym(RTLD_DEFAULT, "openblas_get_num_threads");
  if (!get_threads) GTEST_SKIP() << "linear algebra does not run on OpenBLAS here";
  KeepLinearAlgebraToCaller();
  EXPECT_EQ(reinterpret_cast<GetThreads>(get_threads)(), 1);
}

TEST_F(Parallel, NothingToDoIsDone) {
  ParallelFor(0, [](size_t) { FAIL(); });
}

}  // namespace
}  // namespace parkade
