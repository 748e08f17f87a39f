// A Slurm that refuses, is silent, talks nonsense, loses nodes and forgets.

#include <sys/wait.h>

#include <csignal>

#include "server/jobs/slurm/node_files.h"
#include "server/jobs/slurm/slurm_commands.h"
#include "tests/server/jobs/slurm/slurm_test.h"

namespace parkade {
namespace {

using std::chrono::milliseconds;

class SlurmInTrouble : public SlurmTest {
 protected:
  /// A worker that runs until it is killed; returns its job's number at Slurm.
  std::string StartEndlessJob() {
    Start("exec sleep 1000");
    const std::string id = WaitForId();
    WaitFor(JobState::kRunning);
    Eventually([&] { return !At(id).value("pid", 0) ? false : HasRun(id, 0); });
    return id;
  }
  bool HasRun(const std::string& id, int restarts) const {
    return std::filesystem::exists(RunFolder(Attempt(), id, restarts));
  }
  /// Slurm kills what runs on the node, without a word from it, and says why.
  void EndAs(const std::string& id, const std::string& state, int status = 0) {
    const int pid = At(id).at("pid");
    Set(id, {{"job_state", state}, {"exit_code", status}});
    ::kill(pid, SIGKILL);
  }
};

TEST_F(SlurmInTrouble, AJobThatIsRefusedWaitsAndIsHandedOverLater) {
  Behave("sbatch", "refuse");
  Start(kMakeMap);
  Eventually([&] { return ReasonNow().find("Unable to contact") != std::string::npos; });
  EXPECT_EQ(ShownState(JobNow()), JobState::kQueued);
  Behave("sbatch", "well");

  EXPECT_EQ(WaitFor(JobState::kDone).attempt, 1);
}

TEST_F(SlurmInTrouble, AJobThatSlurmWillNeverTakeFails) {
  Behave("sbatch", "no partition");
  Start(kMakeMap);

  const Job job = WaitFor(JobState::kFailed);
  EXPECT_EQ(job.error_code, "internal");
  EXPECT_EQ(job.error,
            "Slurm does not take the job: sbatch: error: Batch job submission failed: Invalid "
            "partition name specified");
  EXPECT_EQ(job.attempt, 1);
  EXPECT_EQ(CallsOf("sbatch").size(), 1u);
}

TEST(SlurmRefusal, IsFinalWhereNoWaitingHelps) {
  const std::string failed = "sbatch: error: Batch job submission failed: ";
  for (const char* words : {"Requested node configuration is not available",
                            "Invalid account or account/partition combination specified",
                            "More processors requested than permitted"})
    EXPECT_EQ(MaxTries(failed + words), 1) << words;
  for (const char* words : {"Socket timed out on send/recv operation",
                            "Unable to contact slurm controller (connect failure)",
                            "Requested partition configuration not available now",
                            "Required node not available (down, drained or reserved)"})
    EXPECT_FALSE(MaxTries(failed + words)) << words;
  EXPECT_GT(MaxTries(failed + "Job violates accounting/QOS policy (job submit limit, user's size "
                              "and/or time limits)"),
            10);
}

TEST_F(SlurmInTrouble, AnAnswerThatGotLostGivesNoSecondJob) {
  Hold();
  Behave("sbatch", "lose the answer");
  Start(kMakeMap);

  EXPECT_EQ(WaitForId(), "101");
  EXPECT_EQ(JobsAtSlurm().size(), 1u);
  Release();
  EXPECT_EQ(WaitFor(JobState::kDone).attempt, 1);
  EXPECT_EQ(CallsOf("sbatch").size(), 1u);
}

TEST_F(SlurmInTrouble, NonsenseOfSbatchIsNoNumber) {
  Behave("sbatch", "nonsense");
  Start(kMakeMap);
  Eventually([&] { return ReasonNow() == "sbatch says no number of a job"; });
  EXPECT_FALSE(JobNow().place->id);
  Behave("sbatch", "with cluster");
  WaitFor(JobState::kDone);
}

TEST_F(SlurmInTrouble, ACancelledJobThatWasNeverTakenIsCancelled) {
  Behave("sbatch", "refuse");
  Start(kMakeMap);
  Eventually([&] { return !ReasonNow().empty(); });
  runner_->Cancel(received_.job.id);
  WaitFor(JobState::kCancelled);
}

TEST_F(SlurmInTrouble, AQueueThatCannotBeSeenEndsNothing) {
  const std::string go = (root_.path() / "go").string();
  for (const char* mode : {"down", "nonsense", "cut", "slow"}) {
    std::filesystem::remove(go);
    Start("until [ -e " + go + " ]; do sleep 0.05; done; " + kMakeMap);
    const std::string id = WaitForId();
    WaitFor(JobState::kRunning);
    Behave("squeue", mode);
    Eventually([&] { return !ReasonNow().empty(); });
    std::this_thread::sleep_for(milliseconds(700));  // longer than last words may take
    EXPECT_EQ(ShownState(JobNow()), JobState::kRunning) << mode;
    WriteText(go, "");

    EXPECT_EQ(WaitFor(JobState::kDone).attempt, 1) << mode << ": its last word is in its folder";
    Behave("squeue", "well");
    Die();
    received_ = Receive(store_, std::string("a log, ") + mode, {"a.bag", "lot", std::nullopt});
  }
}

TEST_F(SlurmInTrouble, TheReasonOfAnEndWithoutAWordIsSlurms) {
  const std::string id = StartEndlessJob();
  EndAs(id, "OUT_OF_MEMORY");
  const Job job = WaitFor(JobState::kFailed);
  EXPECT_EQ(job.error_code, "out_of_memory");
  EXPECT_EQ(job.attempt, 1);
}

TEST_F(SlurmInTrouble, ATimeLimitOfSlurmsIsSaid) {
  EndAs(StartEndlessJob(), "TIMEOUT");
  EXPECT_EQ(WaitFor(JobState::kFailed).error_code, "time_limit");
}

TEST_F(SlurmInTrouble, AJobThatSomebodyCancelsAtSlurmIsCancelled) {
  EndAs(StartEndlessJob(), "CANCELLED");
  EXPECT_EQ(WaitFor(JobState::kCancelled).error_code, "cancelled");
}

TEST_F(SlurmInTrouble, ALostNodeCostsAnAttempt) {
  EndAs(StartEndlessJob(), "NODE_FAIL");
  Eventually([&] { return JobNow().attempt == 2; });
  EXPECT_EQ(JobNow().crashes, 1);
}

TEST_F(SlurmInTrouble, APreemptedJobIsTriedAgainAndNotBlamed) {
  EndAs(StartEndlessJob(), "PREEMPTED");
  Eventually([&] { return JobNow().attempt == 2; });
  EXPECT_EQ(JobNow().crashes, 0);
}

TEST_F(SlurmInTrouble, AKilledJobIsTriedAgain) {
  EndAs(StartEndlessJob(), "FAILED", SIGKILL);
  Eventually([&] { return JobNow().attempt == 2; });
  EXPECT_EQ(JobNow().crashes, 1);
}

TEST_F(SlurmInTrouble, AForgottenJobWithoutAWordIsTriedAgain) {
  const std::string id = StartEndlessJob();
  ::kill(At(id).at("pid").get<int>(), SIGKILL);
  std::filesystem::remove(slurm_ / "jobs" / (id + ".json"));
  Eventually([&] { return JobNow().attempt == 2; });
}

// Slurm hears nothing of a node and starts the job on another, while the first worker still runs.
TEST_F(SlurmInTrouble, TwoRunsOfOneAttemptDoNotMeet) {
  const std::string id = StartEndlessJob();
  Set(id, {{"job_state", "PENDING"}, {"restart_cnt", 1}});
  WaitFor(JobState::kQueued);
  const std::filesystem::path second = RunFolder(Attempt(), id, 1);
  WriteText(second / "out" / "map.glb", "of the second run");
  WriteText(second / "out" / "report.json", "{}");
  WriteText(second / "progress.ndjson", "{\"stage\": \"mesh\", \"progress\": 0.9}\n");
  Set(id, {{"job_state", "RUNNING"}});
  Eventually([&] {
    const auto progress = runner_->ProgressOf(received_.job.id);
    return progress && progress->stage == "mesh";
  });
  WriteNodeExit(Attempt(), second, {WorkerExit::Kind::kDone, "", ""});

  const Job job = WaitFor(JobState::kDone);
  EXPECT_EQ(job.attempt, 1);
  EXPECT_EQ(job.map_version, 1);
}

TEST_F(SlurmInTrouble, AJobThatSlurmCannotStartIsTriedAgain) {
  Hold();
  Start(kMakeMap);
  const std::string id = WaitForId();
  Set(id, {{"state_reason", "JobHeldUser"}, {"state_description", "launch failed requeued held"}});
  Eventually([&] { return JobNow().attempt == 2; });
  EXPECT_EQ(At(id).at("job_state"), "CANCELLED");
  Release();
  EXPECT_EQ(WaitFor(JobState::kDone).attempt, 2);
}

TEST_F(SlurmInTrouble, AJobThatIsStartedAgainAndAgainIsEnded) {
  const std::string id = StartEndlessJob();
  Set(id, {{"restart_cnt", 5}});
  EXPECT_EQ(WaitFor(JobState::kFailed).error_code, "crashed");
  EXPECT_EQ(At(id).at("job_state"), "CANCELLED");
}

TEST_F(SlurmInTrouble, StraysAreEndedAndOthersLeftAlone) {
  const std::string id = StartEndlessJob();
  const auto plant = [&](const char* number, const std::string& comment,
                         const std::string& folder) {
    WriteText(slurm_ / "jobs" / (std::string(number) + ".json"), "{}");
    Set(number, {{"job_id", std::stoi(number)},
                 {"comment", comment},
                 {"current_working_directory", folder},
                 {"job_state", "RUNNING"}});
  };
  const std::string own = "parkade-" + received_.job.id + "-";
  plant("201", own + "1", Attempt());     // the same attempt, handed over twice
  plant("202", own + "7", Attempt(7));    // of an attempt that is not the running one
  plant("203", own + "7", "/elsewhere");  // of another service
  plant("204", "", "/home/somebody");

  Eventually([&] {
    return At("201").at("job_state") == "CANCELLED" && At("202").at("job_state") == "CANCELLED";
  });
  EXPECT_EQ(At("203").at("job_state"), "RUNNING");
  EXPECT_EQ(At("204").at("job_state"), "RUNNING");
  EXPECT_EQ(At(id).at("job_state"), "RUNNING");
}

// Outside of a job of Slurm's, or after its attempt's folder is gone, the node's program does
// nothing.
TEST_F(SlurmInTrouble, ANodeThatComesTooLateDoesNothing) {
  const std::string gone = (root_.path() / "attempt-1").string();
  const std::string program = NODE_PROGRAM;
  EXPECT_EQ(WEXITSTATUS(std::system((program + " " + gone + " 2>/dev/null").c_str())), 1);
  EXPECT_EQ(
      WEXITSTATUS(std::system(("SLURM_JOB_ID=5 " + program + " " + gone + " 2>/dev/null").c_str())),
      1);
  EXPECT_FALSE(std::filesystem::exists(gone));
}

}  // namespace
}  // namespace parkade
