// Workers that start too much, open too much, write too much, or reach for other processes.

#include "server/jobs/process_group.h"
#include "server/jobs/walls/worker_init.h"
#include "server/jobs/worker_exit.h"
#include "tests/server/jobs/walls/walled.h"
#include "tests/support/sanitizers.h"

namespace parkade {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

class ProcessWall : public Walled {
 protected:
  /// Each in a session of its own, out of reach of its group.
  std::string ForkForEver() const {
    return "exec python3 -c '\"" + mark_ +
           "\"\nimport os, time\nwhile True:\n try:\n  if os.fork() == 0: os.setsid()\n"
           " except OSError: time.sleep(0.01)\n'";
  }
  template <typename Probe>
  bool Eventually(const Probe& probe) const {
    for (int i = 0; i < 3000; ++i, ::usleep(10'000))
      if (probe()) return true;
    return false;
  }

  const std::string mark_ = "bomb-" + root_.path().filename().string();
};

TEST_P(ProcessWall, BoundsAForkBombAndLeavesNothingOfIt) {
  if (kHasSanitizer) GTEST_SKIP() << "a service under a sanitizer is too slow beside a fork bomb";
  constexpr int kMaxTasks = 60;
  int seen = 0;
  AsService([&] {
    WorkerPlace place = Place();
    place.limits.tasks = kMaxTasks;
    WorkerProcess worker({"/bin/sh", "-c", ForkForEver()}, place);
    // Some more looks, lest it grow on.
    for (int looks = 0; looks < 1000 && seen < 50; ++looks, ::usleep(10'000))
      if (ReadWorkerUsage(worker.pid()).tasks >= kMaxTasks) ++seen;
    const bool is_bounded = CountProcessesWith(mark_) <= kMaxTasks + kSpareTasks;
    worker.Signal(SIGKILL);
    if (!worker.Wait(seconds(30)) || seen < 50 || !is_bounded) ::_exit(3);
  });

  EXPECT_EQ(CountProcessesWith(mark_), 0) << ReadFile(folder_ / "log.txt");
}

TEST_P(ProcessWall, EndsWhatAWorkerLeavesBehind) {
  Printed("setsid sleep 1000 " + mark_ + " & setsid sh -c 'sleep 1000; : " + mark_ +
          "' & sleep 0.3");
  EXPECT_EQ(CountProcessesWith(mark_), 0);
}

TEST_P(ProcessWall, FallsWithItsService) {
  const pid_t service = StartAsService([&] {
    WorkerProcess({"/bin/sh", "-c", "setsid sh -c 'sleep 1000; : " + mark_ + "' & sleep 1000"},
                  Place())
        .Wait(seconds(60));
  });
  EXPECT_TRUE(Eventually([&] { return CountProcessesWith(mark_) >= 2; }));
  ::kill(service, SIGKILL);
  ::waitpid(service, nullptr, 0);

  EXPECT_TRUE(Eventually([&] { return CountProcessesWith(mark_) == 0; }));
}

TEST_P(ProcessWall, HidesOtherProcesses) {
  const std::string service = std::to_string(::getpid());
  const std::string printed =
      Printed("kill -0 " + service + " && echo found; kill -KILL -1; ls -d /proc/[0-9]* | wc -l");

  if (printed.find("sees no other process") == std::string::npos) GTEST_SKIP() << printed;
  EXPECT_EQ(printed.find("found"), std::string::npos);
  EXPECT_TRUE(printed.ends_with("\n4\n") || printed.ends_with("\n3\n")) << printed;
}

TEST_P(ProcessWall, EndsAsItsWorkerDoes) {
  for (const auto& [script, status] :
       {std::pair("exit 7", 7 << 8), std::pair("kill -SEGV $$", SIGSEGV),
        std::pair("kill -KILL $$", SIGKILL)})
    AsService([&, script = script, status = status] {
      if (WorkerProcess({"/bin/sh", "-c", script}, Place()).Wait(seconds(60)) != status) ::_exit(3);
    });
}

TEST_P(ProcessWall, BoundsOpenFiles) {
  const std::string printed = Printed(
      "exec python3 -c '\nfiles = []\ntry:\n for i in range(100000): "
      "files.append(open(\"/dev/null\"))\n"
      "except OSError as error: print(len(files), error.strerror)\n'");

  EXPECT_NE(printed.find("Too many open files"), std::string::npos) << printed;
}

TEST_P(ProcessWall, BoundsTheSizeOfAFile) {
  int status = 0;
  ::waitpid(StartAsService([&] {
              WorkerPlace place = Place();
              place.limits.file_bytes = 1'000'000;
              WorkerProcess worker({"/bin/sh", "-c", "exec cat /dev/zero > endless"}, place);
              const int end = worker.Wait(seconds(60)).value_or(0);
              ::_exit(UnderstandEnd(end, {}, false).code == "disk_full" ? 42 : 3);
            }),
            &status, 0);

  EXPECT_EQ(WEXITSTATUS(status), 42);
  EXPECT_EQ(std::filesystem::file_size(folder_ / "endless"), 1'000'000u);
}

TEST_P(ProcessWall, LeavesNoRights) {
  const std::string printed = Printed("grep -E 'CapEff|CapBnd|NoNewPrivs' /proc/self/status");

  const std::string effective = is_nobody() ? "0000000000000000" : "0000000000000002";
  EXPECT_NE(printed.find("CapEff:\t" + effective), std::string::npos) << printed;
  EXPECT_NE(printed.find("CapBnd:\t0000000000000002"), std::string::npos) << printed;
  EXPECT_NE(printed.find("NoNewPrivs:\t1"), std::string::npos) << printed;
}

INSTANTIATE_TEST_SUITE_P(Users, ProcessWall, testing::Values("root", "nobody"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace
}  // namespace parkade
