// Workers that hang, take too much, or say too much: each job ends with the right reason.

#include <unistd.h>

#include <csignal>
#include <thread>

#include "core/files/file.h"
#include "server/jobs/job_runner.h"
#include "server/jobs/log_limit.h"
#include "server/jobs/worker_process.h"
#include "server/store/tables/job_table.h"
#include "server/store/tables/map_table.h"
#include "tests/server/jobs/walls/walled.h"
#include "tests/server/store/temporary_store.h"
#include "tests/support/sanitizers.h"

namespace parkade {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

class JobLimiting : public StoreTest {
 protected:
  static constexpr const char* kMakeMap = "echo glTF > $1/map.glb; echo '{}' > $1/report.json; ";

  /// A worker of one program: $1 is the products' folder, $2 the progress file.
  JobRunnerOptions Program(std::vector<std::string> program) {
    JobRunnerOptions options;
    options.stop_patience = milliseconds(300);
    options.limits.crash_pauses = {};
    options.limits.hang = milliseconds(1500);
    options.command = [program](const JobSpec& spec) {
      std::vector<std::string> command = program;
      command.insert(command.end(), {spec.out, spec.progress});
      return command;
    };
    return options;
  }
  JobRunnerOptions Shell(const std::string& script) {
    return Program({"/bin/sh", "-c", script, "worker"});
  }
  Job JobNow() {
    return store_.database.Read(
        [&](Connection& connection) { return FindJob(connection, received_.job.id); });
  }
  /// Runs the job to its end.
  Job EndOf(const JobRunnerOptions& options) {
    JobRunner runner(store_, events_, options);
    const auto is_over = [&] {
      const JobState state = JobNow().state;
      return state != JobState::kQueued && state != JobState::kRunning;
    };
    for (int i = 0; i < 4000 && !is_over(); ++i) std::this_thread::sleep_for(milliseconds(10));
    runner.Stop();
    return JobNow();
  }
  std::filesystem::path Attempt() const {
    return store_.directory.AttemptFolder(received_.job.id, 1);
  }

  EventHub events_;
  ReceivedDrive received_ = Receive(store_, "a log", {"a.bag", "lot", std::nullopt});
};

TEST_F(JobLimiting, AWorkerThatSleepsForEverHangs) {
  const Job job = EndOf(Shell("echo '{\"stage\": \"track\"}' >> $2; exec sleep 1000"));

  EXPECT_EQ(job.state, JobState::kFailed);
  EXPECT_EQ(job.error_code, "time_limit");
  EXPECT_EQ(job.attempt, 1);
  EXPECT_EQ(job.error,
            "the worker hung in stage 'track': it did nothing at all for 1 seconds and was ended");
}

TEST_F(JobLimiting, AWorkerThatWasStoppedHangs) {
  EXPECT_EQ(EndOf(Shell("kill -STOP $$; " + std::string(kMakeMap))).error_code, "time_limit");
}

TEST_F(JobLimiting, AWorkerInADeadlockHangs) {
  // Either end of the pipe waits for the other.
  EXPECT_EQ(EndOf(Shell("mkfifo f; cat f > f; " + std::string(kMakeMap))).error_code, "time_limit");
}

TEST_F(JobLimiting, AWorkerThatComputesWithoutAWordIsLeftAlone) {
  JobRunnerOptions options =
      Shell("end=$(($(date +%s) + 5)); while [ $(date +%s) -lt $end ]; do :; done; " +
            std::string(kMakeMap));
  EXPECT_EQ(EndOf(options).state, JobState::kDone);
}

TEST_F(JobLimiting, AWorkerThatOnlyComputesIsEndedAtLast) {
  JobRunnerOptions options = Shell("while :; do :; done");
  options.limits.silence = seconds(2);

  const Job job = EndOf(options);
  EXPECT_EQ(job.error_code, "time_limit");
  EXPECT_EQ(job.error, "the worker made no progress for 2 seconds and was ended");
}

TEST_F(JobLimiting, AWorkerThatTakesTooMuchMemoryIsEnded) {
  JobRunnerOptions options = Shell("exec tail /dev/zero");
  options.limits.memory_bytes = 100'000'000;

  const Job job = EndOf(options);
  EXPECT_EQ(job.state, JobState::kFailed);
  EXPECT_EQ(job.error_code, "out_of_memory");
  EXPECT_EQ(job.attempt, 1) << "it would take as much again";
  EXPECT_NE(ReadFile(Attempt() / "log.txt").find("the service limits memory to 95 MiB by "),
            std::string::npos);
}

TEST_F(JobLimiting, TemporaryFilesGoWithTheAttempt) {
  const Job job = EndOf(Shell("echo $TMPDIR; echo left > $TMPDIR/over; exec kill -KILL $$"));

  EXPECT_EQ(job.error_code, "crashed");
  const std::filesystem::path worker = store_.directory.WorkerFolder(received_.job.id);
  EXPECT_NE(ReadFile(Attempt() / "log.txt").find((worker / "attempt-1/tmp").string()),
            std::string::npos);
  for (const std::string& name : ContentOf(worker)) EXPECT_EQ(name, "work/");
}

TEST_F(JobLimiting, AFullDiskIsToldByTheStatusAlone) {
  EXPECT_EQ(EndOf(Shell("exit 4")).error_code, "disk_full");
}

TEST_F(JobLimiting, ALogIsBounded) {
  const Job job =
      EndOf(Shell("echo begins; yes 'a line of the middle' | head -c 60000000; sleep 1; "
                  "echo ends; " +
                  std::string(kMakeMap)));

  EXPECT_EQ(job.state, JobState::kDone);
  const std::string log = ReadFile(Attempt() / "log.txt");
  EXPECT_LT(log.size(), std::size_t{16} << 20);
  EXPECT_GT(log.size(), std::size_t{10} << 20);
  EXPECT_NE(log.substr(0, 1000).find("begins\n"), std::string::npos);
  EXPECT_TRUE(log.ends_with("ends\n"));
  EXPECT_NE(log.find(" MiB of this log were left out here]\n"), std::string::npos);
}

TEST_F(JobLimiting, AControlGroupEndsAWorkerForItsMemory) {
  WorkerPlace place{root_.path(), root_.path() / "log.txt"};
  place.limits.memory_bytes = 50'000'000;
  WorkerProcess worker({"/bin/sh", "-c", "exec tail /dev/zero"}, place);
  if (!worker.cgroup().memory_version()) {
    worker.Signal(SIGKILL);
    GTEST_SKIP() << "no right to make a control group here";
  }
  worker.Wait(seconds(60));
  EXPECT_TRUE(worker.cgroup().HasKilled());
}

TEST_F(JobLimiting, AWorkerThatForksForEverIsEndedAndNothingIsLeft) {
  if (kHasSanitizer) GTEST_SKIP() << "a service under a sanitizer is too slow beside a fork bomb";
  const std::string mark = "bomb-" + root_.path().filename().string();
  JobRunnerOptions options =
      Program({"python3", "-c",
               "'" + mark +
                   "'\nimport os, time\nwhile True:\n try:\n  if os.fork() == 0: os.setsid()\n"
                   " except OSError: time.sleep(0.05)\n"});
  options.limits.tasks = 100;

  const Job job = EndOf(options);
  EXPECT_EQ(job.error_code, "internal");
  EXPECT_EQ(job.error,
            "the worker started the 100 processes and threads that a job may have, and was ended");
  EXPECT_EQ(job.attempt, 1) << "it would start as many again";
  EXPECT_EQ(CountProcessesWith(mark), 0);
}

TEST_F(JobLimiting, AWorkerThatWritesAnEndlessFileIsEnded) {
  JobRunnerOptions options = Shell("exec cat /dev/zero > $1/map.glb");
  options.limits.file_bytes = 10'000'000;

  const Job job = EndOf(options);
  EXPECT_EQ(job.error_code, "disk_full");
  EXPECT_EQ(job.error, "the worker wrote a larger file than a job may, and was ended");
}

TEST_F(JobLimiting, AWorkerSeesOfTheDataDirectoryOnlyItsOwn) {
  const Job job = EndOf(Shell("ls -A " + store_.directory.root().string() + " > $1/seen.txt; " +
                              std::string(kMakeMap)));

  ASSERT_EQ(job.state, JobState::kDone);
  const std::string log = ReadFile(Attempt() / "log.txt");
  if (log.find("(mount namespace)") == std::string::npos) GTEST_SKIP() << log;
  const MapVersion map =
      store_.database.Read([](Connection& connection) { return FindMap(connection, "lot", 1); });
  EXPECT_EQ(ReadFile(store_.directory.MapFolder(map.id) / "seen.txt"), "jobs\n");
}

TEST(MemoryLimit, IsMostOfTheMachine) {
  const std::int64_t all = std::int64_t{::sysconf(_SC_PHYS_PAGES)} * ::sysconf(_SC_PAGESIZE);
  EXPECT_GT(DefaultMemoryLimit(), std::int64_t{64} << 20);
  EXPECT_LT(DefaultMemoryLimit(), all);
}

}  // namespace
}  // namespace parkade
