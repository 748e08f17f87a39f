#include "core/parallel.h"

#include <dlfcn.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <numeric>
#include <set>
#include <stdexcept>
#include <thread>

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

TEST_F(Parallel, ALoopInsideALoopIsHelpedWith) {
  std::mutex mutex;
  std::set<std::thread::id> threads;
  std::condition_variable both;
  ParallelFor(2, [&](size_t outer) {
    if (outer == 1) return;
    ParallelFor(2, [&](size_t) {  // neither is done before both have begun
      std::unique_lock lock(mutex);
      threads.insert(std::this_thread::get_id());
      both.notify_all();
      EXPECT_TRUE(
          both.wait_for(lock, std::chrono::seconds(20), [&] { return threads.size() == 2; }));
    });
  });
}

TEST_F(Parallel, FailuresOfLoopsInsideLoopsComeOut) {
  const auto fails_at = [](size_t outer, size_t inner) { return outer == 3 && inner % 4 == 2; };
  std::atomic<int> num_done{0};
  EXPECT_THROW(ParallelFor(6,
                           [&](size_t outer) {
                             ParallelFor(10, [&](size_t inner) {
                               if (fails_at(outer, inner))
                                 throw std::runtime_error(std::to_string(inner));
                               ++num_done;
                             });
                           }),
               std::runtime_error);
  EXPECT_EQ(num_done, 58);
}

TEST_F(Parallel, ThreadsThatAreNotOfThePoolMayLoopAtOnce) {
  std::atomic<int> count{0};
  std::vector<std::jthread> threads;
  for (int i = 0; i < 4; ++i)
    threads.emplace_back([&] {
      for (int k = 0; k < 50; ++k) ParallelFor(20, [&](size_t) { ++count; });
    });
  threads.clear();
  EXPECT_EQ(count, 4000);
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
