#include "server/jobs/job_runner.h"

#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <thread>

#include "core/error.h"
#include "core/files/file.h"
#include "server/jobs/worker_process.h"
#include "server/store/job_queue.h"
#include "server/store/tables/drive_table.h"
#include "server/store/tables/job_table.h"
#include "server/store/tables/map_table.h"
#include "tests/server/jobs/running_jobs.h"

namespace parkade {
namespace {

using std::chrono::milliseconds;

TEST_F(JobRunning, PublishesWhatTheWorkerMade) {
  const std::int64_t start = events_.last_id();
  JobRunner runner(store_, events_,
                   Shell(std::string(kMakeMap) + "cat $3 > $1/copy.txt; echo hello >&2"));

  const Job job = WaitFor(JobState::kDone);
  runner.Stop();

  const MapVersion map =
      store_.database.Read([](Connection& connection) { return FindMap(connection, "lot", 1); });
  EXPECT_EQ(ReadFile(store_.directory.MapFolder(map.id) / "copy.txt"), "a log");
  EXPECT_TRUE(
      ReadFile(store_.directory.AttemptFolder(job.id, 1) / "log.txt").ends_with("\nhello\n"));
  ExpectNoLeftOvers();
  std::set<std::string> kinds;
  for (const Event& event : events_.WaitFor(start, milliseconds(0)).events)
    kinds.insert(event.kind);
  EXPECT_EQ(kinds, (std::set<std::string>{"drive", "job", "map"}));
}

TEST_F(JobRunning, FailsWithTheSentenceOfBadInputAndDoesNotTryAgain) {
  JobRunner runner(
      store_, events_,
      Shell("echo half > $1/map.glb; echo '{\"error\": \"the log has no IMU\"}' >> $2; exit 1"));

  const Job job = WaitFor(JobState::kFailed);
  runner.Stop();

  EXPECT_EQ(job.attempt, 1);
  EXPECT_EQ(job.error, "the log has no IMU");
  EXPECT_EQ(job.error_code, "invalid_input");
  EXPECT_TRUE(ContentOf(store_.directory.MapsFolder()).empty());
  ExpectNoLeftOvers();
}

TEST_F(JobRunning, TriesACrashedWorkerThreeTimesAndKeepsEachLog) {
  JobRunner runner(store_, events_, Shell("echo attempt; kill -SEGV $$"));

  const Job job = WaitFor(JobState::kFailed);
  runner.Stop();

  EXPECT_EQ(job.attempt, 3);
  EXPECT_EQ(job.error_code, "crashed");
  for (int attempt = 1; attempt <= 3; ++attempt)
    EXPECT_TRUE(ReadFile(store_.directory.AttemptFolder(job.id, attempt) / "log.txt")
                    .ends_with("\nattempt\n"));
}

TEST_F(JobRunning, SucceedsWhenASecondAttemptDoes) {
  JobRunner runner(
      store_, events_,
      Shell("case $PWD in */attempt-1) kill -ABRT $$;; esac; " + std::string(kMakeMap)));

  EXPECT_EQ(WaitFor(JobState::kDone).attempt, 2);
}

TEST_F(JobRunning, ShowsProgressWithATimeLeft) {
  const std::string go = (root_.path() / "go").string();
  JobRunner runner(store_, events_,
                   Shell("echo '{\"stage\": \"track\", \"progress\": 0.5}' >> $2; until [ -e " +
                         go + " ]; do sleep 0.05; done; " + kMakeMap));
  std::optional<JobProgress> progress;
  for (int i = 0; i < 1000 && !(progress && progress->progress == 0.5); ++i) {
    std::this_thread::sleep_for(milliseconds(10));
    progress = runner.ProgressOf(received_.job.id);
  }
  WriteText(go, "");

  ASSERT_TRUE(progress.has_value());
  EXPECT_EQ(progress->stage, "track");
  EXPECT_GT(progress->eta_seconds.value(), 0);
  WaitFor(JobState::kDone);
  for (int i = 0; i < 500 && runner.ProgressOf(received_.job.id); ++i)
    std::this_thread::sleep_for(milliseconds(10));
  EXPECT_FALSE(runner.ProgressOf(received_.job.id).has_value());
}

TEST_F(JobRunning, CancelsAWorkerEvenOneThatDoesNotListen) {
  JobRunner runner(store_, events_, Shell("trap '' TERM; while :; do sleep 0.05; done"));
  WaitFor(JobState::kRunning);
  for (int i = 0; i < 500 && !runner.ProgressOf(received_.job.id); ++i)
    std::this_thread::sleep_for(milliseconds(10));

  runner.Cancel(received_.job.id);

  const Job job = WaitFor(JobState::kCancelled);
  EXPECT_EQ(job.error, "cancelled");
  EXPECT_THROW(runner.Cancel(job.id), Error);
  runner.Stop();
  ExpectNoLeftOvers();
}

TEST_F(JobRunning, CancelsAJobWhoseMapIsBeingSealed) {
  JobRunner runner(store_, events_, Shell(std::string(kMakeMap) + "truncate -s 2G $1/big"));
  const std::filesystem::path big =
      store_.directory.AttemptFolder(received_.job.id, 1) / "out" / "big";
  std::error_code missing;
  const auto is_sealed = [&] {  // or is about to be: hashing takes longer
    using std::filesystem::perms;
    const perms permissions = std::filesystem::status(big, missing).permissions();
    return std::filesystem::exists(big, missing) &&
           (permissions & perms::owner_write) == perms::none;
  };
  for (int i = 0; i < 20'000 && !is_sealed(); ++i) std::this_thread::sleep_for(milliseconds(1));

  runner.Cancel(received_.job.id);

  const Job job = WaitFor(JobState::kCancelled);
  EXPECT_EQ(job.error_code, "cancelled");
  EXPECT_TRUE(ContentOf(store_.directory.MapsFolder()).empty());
}

TEST_F(JobRunning, RefusesToCancelAJobWhoseMapIsBeingPublished) {
  const std::string go = (root_.path() / "go").string();
  JobRunner runner(store_, events_,
                   Shell("until [ -e " + go + " ]; do sleep 0.05; done; " + kMakeMap));
  for (int i = 0; i < 2000 && !JobNow().place; ++i) std::this_thread::sleep_for(milliseconds(10));

  // While nobody else gets at the database, the map is there and not yet published.
  const auto is_there = [&] { return !ContentOf(store_.directory.MapsFolder()).empty(); };
  store_.database.Read([&](Connection&) {
    WriteText(go, "");
    for (int i = 0; i < 2000 && !is_there(); ++i) std::this_thread::sleep_for(milliseconds(10));
  });
  try {
    runner.Cancel(received_.job.id);
    ADD_FAILURE() << "cancelled";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kConflict);
  }

  EXPECT_EQ(WaitFor(JobState::kDone).map_version, 1);
}

TEST_F(JobRunning, SaysThatAMissingRigIsTheInputsFault) {
  store_.database.Write([&](Connection& connection) {
    connection.Execute("UPDATE drives SET rig = 'gone' WHERE id = ?", received_.drive.id);
  });
  JobRunner runner(store_, events_, Shell(kMakeMap));

  const Job job = WaitFor(JobState::kFailed);
  EXPECT_EQ(job.error, "there is no rig 'gone'");
  EXPECT_EQ(job.error_code, "invalid_input");
}

TEST_F(JobRunning, StoppingPutsTheJobBackAndTheNextRunnerDoesIt) {
  {
    JobRunner runner(store_, events_, Shell("sleep 100"));
    WaitFor(JobState::kRunning);
    runner.Stop();
    EXPECT_EQ(JobNow().state, JobState::kQueued);
    EXPECT_EQ(JobNow().crashes, 0);
  }
  JobRunner runner(store_, events_, Shell(kMakeMap));

  EXPECT_EQ(WaitFor(JobState::kDone).attempt, 2);
}

TEST_F(JobRunning, TakesUpAJobOfAServiceThatDied) {
  const Job claimed = *ClaimJob(store_);
  // A worker that outlived its service.
  const pid_t stray = ::fork();
  if (stray == 0) {
    ::setpgid(0, 0);
    ::execlp("sleep", "sleep", "100", nullptr);
    ::_exit(127);
  }
  ::setpgid(stray, stray);
  store_.database.Write([&](Connection& connection) {
    SetJobPlace(
        connection, claimed.id, claimed.attempt,
        {.engine = kLocalEngine, .pid = stray, .pid_started = ProcessStartTime(stray).value()});
  });

  JobRunner runner(store_, events_, Shell(kMakeMap));

  EXPECT_EQ(WaitFor(JobState::kDone).attempt, 2);
  int status = 0;
  EXPECT_EQ(::waitpid(stray, &status, 0), stray);
  EXPECT_EQ(WTERMSIG(status), SIGKILL);
}

TEST_F(JobRunning, AnEndOfTheServiceIsNoCrashOfTheWorker) {
  for (int end = 1; end <= 5; ++end) {
    ClaimJob(store_);
    StartAfterDeath();
    EXPECT_EQ(JobNow().state, JobState::kQueued);
  }
  JobRunner runner(store_, events_, Shell("kill -SEGV $$"));

  EXPECT_EQ(WaitFor(JobState::kFailed).attempt, 5 + 3) << "the worker crashed three times";
}

TEST_F(JobRunning, GivesUpAJobThatTheServiceEndsWithTwentyTimes) {
  for (int end = 1; end <= 20; ++end) {
    ASSERT_TRUE(ClaimJob(store_)) << end;
    StartAfterDeath();
  }

  EXPECT_EQ(JobNow().state, JobState::kFailed);
  EXPECT_EQ(JobNow().error_code, "crashed");
  EXPECT_EQ(JobNow().error, "the service ended 20 times while the job was running");
}

TEST_F(JobRunning, CancelsAJobWhoseServiceDiedMeanwhile) {
  ASSERT_TRUE(ClaimJob(store_));
  NoteCancel(store_, received_.job.id);
  StartAfterDeath();
  EXPECT_EQ(JobNow().state, JobState::kCancelled);

  RetryJob(store_, received_.job.id);
  ASSERT_TRUE(ClaimJob(store_));
  StartAfterDeath();
  EXPECT_EQ(JobNow().state, JobState::kQueued) << "it was asked for once";
}

TEST_F(JobRunning, MapsTheDrivesThatWereNotDeletedMeanwhile) {
  const ReceivedDrive second = Receive(store_, "second", {"b.bag", "lot", std::nullopt});
  const Job both = QueueMap(store_, "lot", {}, /*merge_drives=*/true);
  ASSERT_EQ(both.drives.size(), 2u);
  for (const std::string& job : {received_.job.id, second.job.id}) CancelWaitingJob(store_, job);
  DeleteDrive(store_, received_.drive.id);
  JobRunner runner(store_, events_, Shell(std::string(kMakeMap) + "cat $3 > $1/copy.txt"));

  WaitFor(both.id, JobState::kDone);
  const MapVersion map =
      store_.database.Read([](Connection& connection) { return FindMap(connection, "lot", 1); });
  EXPECT_EQ(ReadFile(store_.directory.MapFolder(map.id) / "copy.txt"), "second");
  ASSERT_EQ(map.drives.size(), 1u);
  EXPECT_EQ(map.drives[0].id, second.drive.id);
}

TEST_F(JobRunning, SaysThatAllDrivesOfAJobWereDeleted) {
  const std::string second = QueueMap(store_, "lot", {received_.drive.id}, true).id;
  CancelWaitingJob(store_, second);  // and with it goes the hold on the drive
  DeleteDrive(store_, received_.drive.id);
  JobRunner runner(store_, events_, Shell(kMakeMap));

  const Job job = WaitFor(JobState::kFailed);
  EXPECT_EQ(job.error, "all drives of this job were deleted");
  EXPECT_EQ(job.error_code, "invalid_input");
  EXPECT_THROW(RetryJob(store_, job.id), Error);
}

TEST_F(JobRunning, EndsAnAttemptThatTakesTooLong) {
  JobRunnerOptions options = Shell("sleep 100");
  options.limits.time = std::chrono::seconds(0);
  JobRunner runner(store_, events_, options);

  EXPECT_NE(WaitFor(JobState::kFailed).error->find("took longer"), std::string::npos);
}

TEST_F(JobRunning, SaysWhenTheWorkerCannotBeStarted) {
  JobRunnerOptions options;
  options.command = [](const JobSpec&) { return std::vector<std::string>{"/nonexistent/worker"}; };
  JobRunner runner(store_, events_, options);

  EXPECT_EQ(WaitFor(JobState::kFailed).error_code, "internal");
}

}  // namespace
}  // namespace parkade
