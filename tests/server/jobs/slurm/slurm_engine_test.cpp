// Jobs at a Slurm that does what it should, and services that come and go meanwhile.

#include "server/jobs/slurm/slurm_engine.h"

#include <csignal>

#include "server/jobs/slurm/node_files.h"
#include "server/store/job_queue.h"
#include "server/store/tables/map_table.h"
#include "tests/server/jobs/slurm/slurm_test.h"

namespace parkade {
namespace {

using std::chrono::milliseconds;

class AtSlurm : public SlurmTest {
 protected:
  /// The service dies before its job's worker begins. The job's number at Slurm, where it has
  /// ended.
  std::string MakeMapWithoutService() {
    Hold();
    Start(kMakeMap);
    const std::string id = WaitForId();
    Die();
    Release();
    Eventually([&] { return At(id).at("job_state") == "COMPLETED"; });
    return id;
  }
};

TEST_F(AtSlurm, AJobIsPublished) {
  Start(std::string(kMakeMap) + "echo hello");

  const Job job = WaitFor(JobState::kDone);
  Die();

  EXPECT_EQ(job.place->engine, "slurm");
  EXPECT_EQ(job.place->id, "101");
  EXPECT_EQ(job.map_version, 1);
  EXPECT_TRUE(ReadFile(Attempt() / "log.txt").ends_with("hello\n"));
  EXPECT_EQ(ContentOf(Attempt()), std::set<std::string>{"log.txt"});
  EXPECT_FALSE(std::filesystem::exists(WorkerFolder(Attempt())));
}

TEST_F(AtSlurm, AJobIsHandedOverWithItsLimits) {
  Hold();
  Start(kMakeMap);
  WaitForId();

  EXPECT_EQ(ReadFile(NodeScript(Attempt())), "#!/bin/sh\nexec \"$@\"\n");
  const auto calls = CallsOf("sbatch");
  ASSERT_EQ(calls.size(), 1u);
  const std::vector<std::string>& words = calls[0];
  const std::string comment = "--comment=parkade-" + received_.job.id + "-1";
  for (const std::string& word :
       {std::string("--parsable"), std::string("--requeue"), std::string("--partition=maps"),
        std::string("--cpus-per-task=2"), std::string("--mem=512M"), std::string("--time=10"),
        std::string("--open-mode=append"), comment, "--chdir=" + Attempt().string()})
    EXPECT_EQ(std::count(words.begin(), words.end(), word), 1) << word;
}

TEST_F(AtSlurm, AWaitingJobIsQueuedAndSaysWhy) {
  Hold();
  Start(kMakeMap);
  WaitForId();
  Eventually([&] { return ReasonNow() == "Resources"; });

  EXPECT_EQ(JobNow().state, JobState::kRunning) << "its attempt holds its place";
  EXPECT_EQ(ShownState(JobNow()), JobState::kQueued);
  store_.database.Read([&](Connection& connection) {
    EXPECT_EQ(CountJobs(connection, JobState::kQueued), 1);
    EXPECT_EQ(ListJobs(connection, {}, JobState::kQueued, std::nullopt).size(), 1u);
    EXPECT_TRUE(ListJobs(connection, {}, JobState::kRunning, std::nullopt).empty());
  });
  Release();
  WaitFor(JobState::kDone);
}

TEST_F(AtSlurm, ProgressIsFollowed) {
  Start("echo '{\"stage\": \"track\", \"progress\": 0.5}' >> $2; sleep 100");
  Eventually([&] {
    const auto progress = runner_->ProgressOf(received_.job.id);
    return progress && progress->progress == 0.5 && progress->stage == "track";
  });
}

TEST_F(AtSlurm, AJobIsCancelledWhetherItWaitsOrRuns) {
  Hold();
  Start("trap '' TERM; while :; do sleep 0.05; done");
  const std::string first = WaitForId();
  runner_->Cancel(received_.job.id);
  EXPECT_EQ(WaitFor(JobState::kCancelled).error_code, "cancelled");
  EXPECT_EQ(At(first).at("job_state"), "CANCELLED");

  Release();
  RetryJob(store_, received_.job.id);
  runner_->Wake();
  Eventually([&] { return JobNow().attempt == 2; });
  const std::string second = WaitForId();
  Eventually([&] { return std::filesystem::exists(RunFolder(Attempt(2), second, 0)); });
  const auto begun = std::chrono::steady_clock::now();
  runner_->Cancel(received_.job.id);
  WaitFor(JobState::kCancelled);
  EXPECT_LT(std::chrono::steady_clock::now() - begun, std::chrono::seconds(5));
  Eventually([&] { return !std::filesystem::exists(Attempt(2) / "runs"); });
}

TEST_F(AtSlurm, AWorkersOwnEndIsTheJobsEnd) {
  Start("echo '{\"error\": \"the log has no IMU\", \"code\": \"invalid_input\"}' >> $2; exit 1");
  const Job job = WaitFor(JobState::kFailed);
  EXPECT_EQ(job.error, "the log has no IMU");
  EXPECT_EQ(job.error_code, "invalid_input");
  EXPECT_EQ(job.attempt, 1);
}

TEST_F(AtSlurm, ACrashedWorkerIsStartedAgain) {
  Start("case $PWD in */attempt-1-*) kill -SEGV $$;; esac; " + std::string(kMakeMap));

  EXPECT_EQ(WaitFor(JobState::kDone).attempt, 2);
  EXPECT_EQ(CallsOf("sbatch").size(), 2u);
}

TEST_F(AtSlurm, TheNextServiceTakesUpARunningJob) {
  const std::string go = (root_.path() / "go").string();
  const std::string script = "until [ -e " + go + " ]; do sleep 0.05; done; " + kMakeMap;
  Start(script);
  const std::string id = WaitForId();
  Eventually([&] { return std::filesystem::exists(RunFolder(Attempt(), id, 0)); });
  Die();
  EXPECT_EQ(JobNow().state, JobState::kRunning);
  ReconcileFiles(store_);
  Start(script);
  WriteText(go, "");

  EXPECT_EQ(WaitFor(JobState::kDone).attempt, 1);
  EXPECT_EQ(CallsOf("sbatch").size(), 1u);
}

TEST_F(AtSlurm, TheNextServiceFindsAJobThatEndedWithoutOne) {
  const std::string id = MakeMapWithoutService();
  std::filesystem::remove(slurm_ / "jobs" / (id + ".json"));  // forgotten after some minutes
  Start(kMakeMap);

  EXPECT_EQ(WaitFor(JobState::kDone).attempt, 1);
}

// The last service died between moving the products and the version.
TEST_F(AtSlurm, AJobWhoseProductsAreGoneIsRunAgain) {
  const std::string id = MakeMapWithoutService();
  std::filesystem::remove_all(RunFolder(Attempt(), id, 0) / "out");
  Start(kMakeMap);

  EXPECT_EQ(WaitFor(JobState::kDone).attempt, 2);
}

TEST_F(AtSlurm, AServiceThatDiesBeforeItNotesTheNumberLeavesNoOrphan) {
  Hold();
  Start(kMakeMap);
  const std::string id = WaitForId();
  Die();
  store_.database.Write([&](Connection& connection) {
    SetJobPlace(connection, received_.job.id, 1, {.engine = "slurm", .waits = true});
  });
  Start(kMakeMap);
  EXPECT_EQ(WaitForId(), id) << "found by its comment";
  Release();

  EXPECT_EQ(WaitFor(JobState::kDone).attempt, 1);
  EXPECT_EQ(CallsOf("sbatch").size(), 1u);
}

TEST_F(AtSlurm, AServiceThatDiesBeforeItHandsOverDoesSoLater) {
  Hold();
  Start(kMakeMap);
  const std::string id = WaitForId();
  Die();
  store_.database.Write([&](Connection& connection) {
    SetJobPlace(connection, received_.job.id, 1, {.engine = "slurm", .waits = true});
  });
  std::filesystem::remove(slurm_ / "jobs" / (id + ".json"));  // it never was there
  Release();
  Start(kMakeMap);

  EXPECT_EQ(WaitFor(JobState::kDone).attempt, 1);
}

TEST_F(AtSlurm, AServiceOfAnotherEngineDoesTheJobItself) {
  Hold();
  Start("true");
  const std::string id = WaitForId();
  Die();
  ReconcileFiles(store_);
  JobRunnerOptions options;
  options.command = [](const JobSpec& spec) {
    return std::vector<std::string>{"/bin/sh", "-c", kMakeMap, "worker", spec.out, spec.progress};
  };
  JobRunner local(store_, events_, options);

  const Job job = WaitFor(JobState::kDone);
  EXPECT_EQ(job.attempt, 2);
  EXPECT_EQ(job.place->engine, kLocalEngine);
}

}  // namespace
}  // namespace parkade
