#include "server/jobs/worker_watch.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <thread>
#include <vector>

namespace parkade {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

class WorkerWatching : public testing::Test {
 protected:
  /// Looks five times a second for `time` at what `usage` says after so many seconds.
  template <typename Usage>
  WorkerTrouble WatchFor(seconds time, const Usage& usage, bool speaks = false) {
    for (milliseconds passed{0}; passed < time; passed += milliseconds(200)) {
      now_ += milliseconds(200);
      const WorkerTrouble trouble =
          watch_.Look(usage(std::chrono::duration<double>(passed).count()), speaks, now_);
      if (trouble != WorkerTrouble::kNone) return trouble;
    }
    return WorkerTrouble::kNone;
  }

  JobLimits limits_{.time = seconds(100'000),
                    .hang = seconds(20),
                    .silence = seconds(3600),
                    .memory_bytes = 1000};
  WorkerWatch::Clock::time_point now_{};
  WorkerWatch watch_{limits_, now_};
};

TEST_F(WorkerWatching, OneThatDoesNothingHangs) {
  EXPECT_EQ(WatchFor(seconds(19), [](double) { return GroupUsage{}; }), WorkerTrouble::kNone);
  EXPECT_EQ(WatchFor(seconds(2), [](double) { return GroupUsage{}; }), WorkerTrouble::kHangs);
}

TEST_F(WorkerWatching, TimersOfIdleThreadsAreNoLife) {
  const auto usage = [](double time) { return GroupUsage{.processor_seconds = 0.001 * time}; };
  EXPECT_EQ(WatchFor(seconds(30), usage), WorkerTrouble::kHangs);
}

TEST_F(WorkerWatching, ASlowHonestOneIsLeftAlone) {
  const auto computes = [](double time) { return GroupUsage{.processor_seconds = 0.02 * time}; };
  const auto reads = [](double time) {
    return GroupUsage{.disk_bytes = static_cast<std::int64_t>(time / 10) * 4096};
  };
  const auto waits_for_disk = [](double) { return GroupUsage{.is_busy = true}; };
  EXPECT_EQ(WatchFor(seconds(900), computes), WorkerTrouble::kNone);
  EXPECT_EQ(WatchFor(seconds(900), reads), WorkerTrouble::kNone);
  EXPECT_EQ(WatchFor(seconds(900), waits_for_disk), WorkerTrouble::kNone);
}

TEST_F(WorkerWatching, OneThatOnlyBurnsTimeIsSilentInTheEnd) {
  const auto computes = [](double time) { return GroupUsage{.processor_seconds = time}; };
  EXPECT_EQ(WatchFor(seconds(3599), computes), WorkerTrouble::kNone);
  EXPECT_EQ(WatchFor(seconds(2), computes), WorkerTrouble::kIsSilent);
}

TEST_F(WorkerWatching, ProgressIsLife) {
  EXPECT_EQ(WatchFor(
                seconds(7200), [](double) { return GroupUsage{}; }, /*speaks=*/true),
            WorkerTrouble::kNone);
}

TEST_F(WorkerWatching, TimeWithoutLooksIsNotTheWorkersFault) {
  now_ += seconds(300);  // the service itself was stopped
  EXPECT_EQ(watch_.Look({}, false, now_), WorkerTrouble::kNone);
}

TEST_F(WorkerWatching, MemoryHasALimit) {
  EXPECT_EQ(watch_.Look({.memory_bytes = 1000}, true, now_), WorkerTrouble::kNone);
  EXPECT_EQ(watch_.Look({.memory_bytes = 1001}, true, now_), WorkerTrouble::kOverMemory);
}

/// A process in a group of its own that does `work`.
template <typename Work>
pid_t StartGroup(const Work& work) {
  const pid_t child = ::fork();
  if (child == 0) {
    ::setpgid(0, 0);
    work();
    ::_exit(0);
  }
  ::setpgid(child, child);
  return child;
}

void EndGroup(pid_t group) {
  ::kill(-group, SIGKILL);
  ::waitpid(group, nullptr, 0);
}

TEST(GroupUsage, CountsMemoryAndProcessorTime) {
  const pid_t group = StartGroup([] {
    std::vector<char> memory(50'000'000, 'x');
    volatile std::uint64_t count = 0;
    while (true) count = count + static_cast<unsigned char>(memory[count % memory.size()]);
  });
  GroupUsage usage;
  for (int i = 0; i < 200 && !(usage.processor_seconds > 0.3 && usage.memory_bytes > 50'000'000);
       ++i) {
    std::this_thread::sleep_for(milliseconds(50));
    usage = ReadWorkerUsage(group);
  }
  EndGroup(group);

  EXPECT_GE(usage.memory_bytes, 50'000'000);
  EXPECT_LT(usage.memory_bytes, 500'000'000);
  EXPECT_GE(usage.processor_seconds, 0.3);
  EXPECT_TRUE(usage.is_busy);
  EXPECT_EQ(ReadWorkerUsage(group).memory_bytes, 0) << "it has ended";
}

TEST(GroupUsage, SeesThatAStoppedOneDoesNothing) {
  const pid_t group = StartGroup([] {
    while (true) {
    }
  });
  ::kill(-group, SIGSTOP);
  std::this_thread::sleep_for(milliseconds(100));
  const GroupUsage before = ReadWorkerUsage(group);
  std::this_thread::sleep_for(milliseconds(300));
  const GroupUsage after = ReadWorkerUsage(group);
  EndGroup(group);

  EXPECT_FALSE(after.is_busy);
  EXPECT_EQ(after.processor_seconds, before.processor_seconds);
}

}  // namespace
}  // namespace parkade
