// Several drives of a site, prepared by an array of jobs before the job that joins them.

#include "server/jobs/slurm/slurm_preparation.h"

#include <csignal>

#include "server/jobs/slurm/node_files.h"
#include "server/store/job_queue.h"
#include "tests/server/jobs/slurm/slurm_test.h"

namespace parkade {
namespace {

/// A job of two drives. Each preparation leaves a file in the work, which the run counts.
class SlurmPreparationTest : public SlurmTest {
 protected:
  static constexpr const char* kPrepare =
      "if [ $3 -gt 0 ]; then echo preparing $3; touch $4/$3; exit; fi; ";
  static constexpr const char* kCount = "echo found $(ls $4 | wc -l); ";
  static constexpr const char* kWaitInPreparation =
      "if [ $3 -gt 0 ]; then echo '{\"stage\": \"track\", \"progress\": 0.5}' >> $2; "
      "until [ -e $4/go ]; do sleep 0.05; done; touch $4/$3; exit; fi; ";

  SlurmPreparationTest() {
    const ReceivedDrive second = Receive(store_, "another log", {"b.bag", "lot", std::nullopt});
    CancelWaitingJob(store_, received_.job.id);
    CancelWaitingJob(store_, second.job.id);
    received_.job = QueueMap(store_, "lot", {}, /*merge_drives=*/true);
  }

  std::string Log() { return ReadFile(Attempt() / "log.txt"); }
  std::filesystem::path Work() const { return store_.directory.WorkFolder(received_.job.id); }
  /// All elements run.
  void WaitForElements() {
    Eventually([&] {
      return JobsAtSlurm().size() == 3 && At("101").at("job_state") == "RUNNING" &&
             At("102").at("job_state") == "RUNNING";
    });
  }
};

TEST_F(SlurmPreparationTest, AnArrayPreparesTheDrivesAndTheRunWaitsForIt) {
  Start(std::string(kPrepare) + kCount + kMakeMap);

  EXPECT_EQ(WaitFor(JobState::kDone).attempt, 1);
  const auto calls = CallsOf("sbatch");
  ASSERT_EQ(calls.size(), 2u);
  EXPECT_EQ(std::count(calls[0].begin(), calls[0].end(), "--array=0-1"), 1);
  EXPECT_EQ(std::count(calls[1].begin(), calls[1].end(), "--dependency=afterany:101"), 1);
  EXPECT_NE(Log().find("preparing 1\n"), std::string::npos) << Log();
  EXPECT_NE(Log().find("preparing 2\n"), std::string::npos) << Log();
  EXPECT_TRUE(Log().ends_with("found 2\n")) << Log();
  Eventually([&] { return !std::filesystem::exists(Work()); });
}

TEST_F(SlurmPreparationTest, OneDriveThatNothingIsKnownOfNeedsNoArray) {
  std::filesystem::create_directories(Work() / "a");
  WriteText(Work() / "a" / "odometry.bin", "of an earlier attempt");
  Start(std::string(kPrepare) + kMakeMap);

  WaitFor(JobState::kDone);
  EXPECT_EQ(CallsOf("sbatch").size(), 1u);
}

TEST_F(SlurmPreparationTest, AJobRunsWhileItsDrivesArePrepared) {
  Start(std::string(kWaitInPreparation) + kMakeMap);
  WaitForElements();

  Eventually([&] { return ShownState(JobNow()) == JobState::kRunning; });
  Eventually([&] {
    const auto progress = runner_->ProgressOf(received_.job.id);
    return progress && progress->stage == "prepare drives" && progress->progress == 0.3;
  });
  WriteText(Work() / "go", "");
  WaitFor(JobState::kDone);
}

TEST_F(SlurmPreparationTest, ARefusedArrayLeavesAllToTheRun) {
  Behave("sbatch", "refuse arrays");
  Start(std::string(kPrepare) + kCount + kMakeMap);

  EXPECT_EQ(WaitFor(JobState::kDone).attempt, 1);
  EXPECT_TRUE(Log().ends_with("found 0\n")) << Log();
}

TEST_F(SlurmPreparationTest, AFailedPreparationIsLeftToTheRun) {
  Start("if [ $3 = 1 ]; then kill -SEGV $$; fi; " + std::string(kPrepare) + kCount + kMakeMap);

  EXPECT_EQ(WaitFor(JobState::kDone).attempt, 1);
  EXPECT_TRUE(Log().ends_with("found 1\n")) << Log();
}

TEST_F(SlurmPreparationTest, AnElementThatSlurmHoldsIsGivenUp) {
  Hold();
  Start(std::string(kPrepare) + kCount + kMakeMap);
  Eventually([&] { return JobsAtSlurm().size() == 3; });
  Set("102", {{"state_description", "launch failed requeued held"}});
  Eventually([&] { return At("102").at("job_state") == "CANCELLED"; });
  Release();

  EXPECT_EQ(WaitFor(JobState::kDone).attempt, 1);
  EXPECT_TRUE(Log().ends_with("found 1\n")) << Log();
}

TEST_F(SlurmPreparationTest, CancellingEndsTheElementsToo) {
  Start(std::string(kWaitInPreparation) + kMakeMap);
  WaitForElements();
  WaitForId();
  const std::vector<int> pids = {At("101").at("pid"), At("102").at("pid")};

  runner_->Cancel(received_.job.id);
  EXPECT_EQ(WaitFor(JobState::kCancelled).error_code, "cancelled");
  for (const std::string& id : JobsAtSlurm()) EXPECT_EQ(At(id).at("job_state"), "CANCELLED") << id;
  for (const int pid : pids) Eventually([&] { return ::kill(pid, 0) != 0; });
}

TEST_F(SlurmPreparationTest, TheNextServiceHandsOverNoSecondArray) {
  const std::string script = std::string(kWaitInPreparation) + kCount + kMakeMap;
  Start(script);
  WaitForElements();
  Die();
  // It died before the run was handed over.
  std::filesystem::remove(slurm_ / "jobs" / "103.json");
  store_.database.Write([&](Connection& connection) {
    SetJobPlace(connection, received_.job.id, 1, {.engine = "slurm", .waits = true});
  });
  ReconcileFiles(store_);
  Start(script);
  Eventually([&] { return CallsOf("sbatch").size() == 3; });
  WriteText(Work() / "go", "");

  EXPECT_EQ(WaitFor(JobState::kDone).attempt, 1);
  const auto calls = CallsOf("sbatch");
  ASSERT_EQ(calls.size(), 3u);
  EXPECT_EQ(std::count(calls[2].begin(), calls[2].end(), "--dependency=afterany:101"), 1);
}

TEST_F(SlurmPreparationTest, ElementsThatNobodyWaitsForAreEnded) {
  Start(std::string(kWaitInPreparation) + kMakeMap);
  WaitForElements();
  Die();
  FailJob(store_, JobNow(), "internal", "it was given up");
  Start(kMakeMap);

  Eventually([&] {
    return At("101").at("job_state") == "CANCELLED" && At("102").at("job_state") == "CANCELLED";
  });
}

}  // namespace
}  // namespace parkade
