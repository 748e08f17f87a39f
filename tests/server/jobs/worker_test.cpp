#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "core/error.h"
#include "core/files/file.h"
#include "server/jobs/worker_exit.h"
#include "server/jobs/worker_process.h"
#include "tests/server/jobs/walls/walled.h"
#include "tests/server/store/temporary_store.h"

namespace parkade {
namespace {

using std::chrono::milliseconds;

class Worker : public testing::Test {
 protected:
  std::unique_ptr<WorkerProcess> Start(const std::string& script) {
    return std::make_unique<WorkerProcess>(std::vector<std::string>{"/bin/sh", "-c", script},
                                           WorkerPlace{root_.path(), log_});
  }
  int StatusOf(const std::string& script) {
    return Start(script)->Wait(milliseconds(60'000)).value();
  }
  std::string Printed() const { return ReadFile(log_); }

  TemporaryRoot root_;
  std::filesystem::path log_ = root_.path() / "log.txt";
};

TEST_F(Worker, RunsInItsFolderAndPrintsToTheLog) {
  const int status = StatusOf("pwd; echo said >&2; exit 7");

  EXPECT_EQ(WEXITSTATUS(status), 7);
  EXPECT_EQ(Printed(), std::filesystem::canonical(root_.path()).string() + "\nsaid\n");
}

TEST_F(Worker, IsPoliteAndLeavesNoCore) {
  StatusOf("ulimit -c; nice; cat /proc/self/oom_score_adj");

  const int own_nice = ::getpriority(PRIO_PROCESS, 0);
  EXPECT_EQ(Printed(), "0\n" + std::to_string(std::min(own_nice + 10, 19)) + "\n800\n");
}

TEST_F(Worker, InheritsNoOpenFiles) {
  const int leaked =
      ::open("/dev/null", O_RDONLY);  // without O_CLOEXEC, like the sockets of the HTTP library
  StatusOf("exec ls /proc/self/fd");
  ::close(leaked);

  EXPECT_EQ(Printed(), "0\n1\n2\n3\n") << "3 is the folder that ls reads";
}

TEST_F(Worker, ThatCannotStartSaysSo) {
  try {
    WorkerProcess({"/nonexistent/program"}, {root_.path(), log_});
    FAIL() << "started";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("No such file"), std::string::npos);
  }
}

TEST_F(Worker, IsSignaledWithItsWholeGroup) {
  const std::string mark = root_.path().filename();
  const auto worker = Start("sh -c 'sleep 100; : " + mark + "' & echo started; wait");
  while (!std::filesystem::exists(log_) || Printed().empty())
    EXPECT_FALSE(worker->Wait(milliseconds(10)));

  worker->Signal(SIGTERM);
  const int status = worker->Wait(milliseconds(60'000)).value();

  EXPECT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(CountProcessesWith(mark), 0);
}

TEST_F(Worker, DiesWithItsOwner) {
  pid_t pid = 0;
  {
    const auto worker = Start("sleep 100");
    pid = worker->pid();
    EXPECT_TRUE(ProcessStartTime(pid).has_value());
  }
  EXPECT_FALSE(ProcessStartTime(pid).has_value());
}

TEST_F(Worker, EndIsUnderstood) {
  EXPECT_EQ(UnderstandEnd(StatusOf("exit 0"), {}, false).kind, WorkerExit::Kind::kDone);

  WorkerProgress last_words;
  last_words.stage = "track";
  last_words.error = "the log has no IMU";
  const WorkerExit failed = UnderstandEnd(StatusOf("exit 1"), last_words, false);
  EXPECT_EQ(failed.kind, WorkerExit::Kind::kFailed);
  EXPECT_EQ(failed.code, "invalid_input");
  EXPECT_EQ(failed.sentence, "the log has no IMU");

  for (const auto& [said, code] :
       {std::pair("usage", "invalid_input"), std::pair("not_found", "invalid_input"),
        std::pair("conflict", "internal"), std::pair("disk_full", "disk_full"),
        std::pair("nonsense", "internal")}) {
    last_words.code = said;
    EXPECT_EQ(UnderstandEnd(StatusOf("exit 2"), last_words, false).code, code) << said;
  }

  const WorkerExit silent = UnderstandEnd(StatusOf("exit 3"), {}, false);
  EXPECT_EQ(silent.kind, WorkerExit::Kind::kFailed);
  EXPECT_EQ(silent.code, "internal");
  EXPECT_EQ(silent.sentence, "the worker ended with status 3 and gave no reason");

  const WorkerExit crashed = UnderstandEnd(StatusOf("kill -SEGV $$"), last_words, false);
  EXPECT_EQ(crashed.kind, WorkerExit::Kind::kCrashed);
  EXPECT_EQ(crashed.sentence, "the worker crashed in stage 'track': Segmentation fault");

  const int killed = StatusOf("kill -KILL $$");
  EXPECT_EQ(UnderstandEnd(killed, {}, false).code, "crashed");
  EXPECT_EQ(UnderstandEnd(killed, {}, true).code, "out_of_memory");
  EXPECT_EQ(UnderstandEnd(StatusOf("kill -SEGV $$"), {}, true).code, "crashed")
      << "another process was killed for memory meanwhile";
}

TEST_F(Worker, EndsWithAStatusForEachClassWhateverItsLastWordsAre) {
  WorkerProgress cut_off;
  cut_off.code = "invalid_input";
  for (const auto& [status, code] :
       {std::pair("4", "disk_full"), std::pair("5", "out_of_memory")}) {
    const int end = StatusOf(std::string("exit ") + status);
    EXPECT_EQ(UnderstandEnd(end, {}, false).code, code);
    EXPECT_EQ(UnderstandEnd(end, cut_off, false).code, code);
    EXPECT_EQ(UnderstandEnd(end, {}, false).sentence.find("gave no reason"), std::string::npos);
  }
}

TEST_F(Worker, PutsTemporaryFilesWhereItIsTold) {
  WorkerProcess worker({"/bin/sh", "-c", "echo $TMPDIR; env | grep -c ^TMPDIR="},
                       {root_.path(), log_, "/some/where"});
  worker.Wait(milliseconds(60'000));

  EXPECT_EQ(Printed(), "/some/where\n1\n");
}

// Needs a kernel that lets us make a namespace; the log says whether it did.
TEST_F(Worker, ReachesNoNetwork) {
  WorkerPlace place{root_.path(), log_};
  place.says_walls = true;
  WorkerProcess worker({"/bin/sh", "-c", "cat /proc/net/dev; id -u"}, place);
  ASSERT_EQ(worker.Wait(milliseconds(60'000)).value(), 0);

  const std::string printed = Printed();
  if (printed.find("the worker keeps the network") != std::string::npos) GTEST_SKIP() << printed;
  EXPECT_NE(printed.find("the worker is shut off from the network\n"), std::string::npos)
      << printed;
  std::istringstream lines(printed);
  int interfaces = 0;
  for (std::string line; std::getline(lines, line);)
    if (line.find(": ") < 8) {
      ++interfaces;
      EXPECT_NE(line.find("lo:"), std::string::npos) << line;
    }
  EXPECT_EQ(interfaces, 1);
  EXPECT_TRUE(printed.ends_with("\n" + std::to_string(::getuid()) + "\n")) << "it is who it was";
}

TEST(ProcessStartTime, TellsProcessesApart) {
  EXPECT_EQ(ProcessStartTime(::getpid()), ProcessStartTime(::getpid()));
  EXPECT_GT(ProcessStartTime(::getpid()).value(), ProcessStartTime(1).value());
  EXPECT_FALSE(ProcessStartTime(999'999'999).has_value());
}

}  // namespace
}  // namespace parkade
