#include "server/store/job_queue.h"

#include <thread>

#include "core/error.h"
#include "server/store/publish_map.h"
#include "server/store/tables/drive_table.h"
#include "server/store/tables/job_table.h"
#include "server/store/tables/map_table.h"
#include "tests/server/store/temporary_store.h"

namespace parkade {
namespace {

class JobQueue : public StoreTest {
 protected:
  void Crash(const Job& job, std::chrono::milliseconds pause = {}) {
    RetryCrashedJob(store_, job, "crashed", "segmentation fault", pause);
  }
  Job JobNow() {
    return store_.database.Read(
        [&](Connection& connection) { return FindJob(connection, received_.job.id); });
  }
  Drive DriveNow() {
    return store_.database.Read(
        [&](Connection& connection) { return FindDrive(connection, received_.drive.id); });
  }

  void MakeReady(const std::string& drive) {
    store_.database.Write([&](Connection& connection) {
      SetDriveState(connection, drive, DriveState::kReady, std::nullopt);
    });
  }

  ReceivedDrive received_ = Receive(store_, "a log", {"a.bag", "lot", std::nullopt});
};

TEST_F(JobQueue, GivesOutTheOldestJobOnce) {
  const ReceivedDrive later = Receive(store_, "later", {"b.bag", "lot", std::nullopt});

  const std::optional<Job> first = ClaimJob(store_), second = ClaimJob(store_),
                           third = ClaimJob(store_);

  EXPECT_EQ(first->id, received_.job.id);
  EXPECT_EQ(first->attempt, 1);
  EXPECT_EQ(second->id, later.job.id);
  EXPECT_FALSE(third.has_value());
  EXPECT_EQ(JobNow().state, JobState::kRunning);
  EXPECT_EQ(DriveNow().state, DriveState::kProcessing);
}

TEST_F(JobQueue, AFailureReachesTheDrive) {
  FailJob(store_, *ClaimJob(store_), "invalid_input", "the log has no IMU");

  EXPECT_EQ(JobNow().state, JobState::kFailed);
  EXPECT_EQ(JobNow().error_code, "invalid_input");
  EXPECT_EQ(DriveNow().state, DriveState::kFailed);
  EXPECT_EQ(DriveNow().error, "the log has no IMU");
}

TEST_F(JobQueue, ACrashedJobIsTriedThreeTimesInAll) {
  for (int attempt = 1; attempt <= 3; ++attempt) {
    const std::optional<Job> job = ClaimJob(store_);
    ASSERT_TRUE(job.has_value());
    EXPECT_EQ(job->attempt, attempt);
    Crash(*job);
  }
  EXPECT_FALSE(ClaimJob(store_).has_value());
  EXPECT_EQ(JobNow().state, JobState::kFailed);
  EXPECT_EQ(JobNow().error_code, "crashed");

  RetryJob(store_, received_.job.id);
  EXPECT_EQ(ClaimJob(store_)->attempt, 4) << "attempts count on, so that their folders differ";
}

TEST_F(JobQueue, ACrashedJobWaitsAndOthersGoFirst) {
  const ReceivedDrive later = Receive(store_, "later", {"b.bag", "lot", std::nullopt});
  Crash(*ClaimJob(store_), std::chrono::hours(1));

  EXPECT_GT(JobNow().not_before.value(), UtcIn(std::chrono::minutes(59)));
  EXPECT_EQ(ClaimJob(store_)->id, later.job.id);
  EXPECT_FALSE(ClaimJob(store_).has_value());

  RetryJob(store_, received_.job.id);
  EXPECT_FALSE(JobNow().not_before.has_value());
  EXPECT_EQ(ClaimJob(store_)->id, received_.job.id) << "by hand it starts at once";
}

TEST_F(JobQueue, ACrashedJobStartsWhenItsPauseIsOver) {
  Crash(*ClaimJob(store_), std::chrono::milliseconds(50));
  EXPECT_FALSE(ClaimJob(store_).has_value());
  std::this_thread::sleep_for(std::chrono::milliseconds(60));

  const std::optional<Job> again = ClaimJob(store_);
  ASSERT_TRUE(again.has_value());
  EXPECT_FALSE(again->not_before.has_value());
}

TEST_F(JobQueue, AStoppedServiceDoesNotCountAsACrash) {
  for (int i = 0; i < 5; ++i) ReturnJob(store_, *ClaimJob(store_));

  EXPECT_EQ(JobNow().state, JobState::kQueued);
  EXPECT_EQ(JobNow().crashes, 0);
}

TEST_F(JobQueue, AnAttemptThatWasGivenUpChangesNothing) {
  const Job zombie = *ClaimJob(store_);
  Crash(zombie);
  const Job current = *ClaimJob(store_);

  FailJob(store_, zombie, "internal", "too late");
  FinishCancelledJob(store_, zombie);
  ReturnJob(store_, zombie);

  EXPECT_EQ(JobNow().state, JobState::kRunning);
  EXPECT_EQ(JobNow().attempt, current.attempt);
}

TEST_F(JobQueue, AWaitingJobIsCancelledAtOnceARunningOneIsNot) {
  EXPECT_TRUE(CancelWaitingJob(store_, received_.job.id));
  EXPECT_EQ(JobNow().state, JobState::kCancelled);
  EXPECT_EQ(DriveNow().state, DriveState::kReceived);
  EXPECT_THROW(CancelWaitingJob(store_, received_.job.id), Error);

  RetryJob(store_, received_.job.id);
  const Job job = *ClaimJob(store_);
  EXPECT_FALSE(CancelWaitingJob(store_, job.id));
  FinishCancelledJob(store_, job);
  EXPECT_EQ(JobNow().state, JobState::kCancelled);
}

TEST_F(JobQueue, OnlyEndedJobsAreRetriedAndOnlyWithTheirDrives) {
  EXPECT_THROW(RetryJob(store_, received_.job.id), Error);
  EXPECT_THROW(RetryJob(store_, "0000000000000000"), Error);
  CancelWaitingJob(store_, received_.job.id);
  DeleteDrive(store_, received_.drive.id);
  EXPECT_THROW(RetryJob(store_, received_.job.id), Error);
}

TEST_F(JobQueue, ADriveDeletedMeanwhileIsLeftOut) {
  const ReceivedDrive second = Receive(store_, "second", {"b.bag", "lot", std::nullopt});
  CancelWaitingJob(store_, second.job.id);
  CancelWaitingJob(store_, received_.job.id);
  MakeReady(received_.drive.id);
  const Job both = QueueMap(store_, "lot", {}, /*merge_drives=*/true);
  ASSERT_EQ(both.drives.size(), 2u);
  MakeReady(received_.drive.id);

  DeleteDrive(store_, received_.drive.id);

  const std::optional<Job> claimed = ClaimJob(store_);
  EXPECT_EQ(claimed->id, both.id);
  EXPECT_EQ(claimed->drives, std::vector{second.drive.id});
}

TEST_F(JobQueue, AnEndedJobIsRetriedWithTheDrivesThatAreLeft) {
  const ReceivedDrive second = Receive(store_, "second", {"b.bag", "lot", std::nullopt});
  const Job both = QueueMap(store_, "lot", {}, /*merge_drives=*/true);
  for (const std::string& job : {received_.job.id, second.job.id, both.id})
    CancelWaitingJob(store_, job);
  DeleteDrive(store_, received_.drive.id);

  EXPECT_EQ(RetryJob(store_, both.id).drives, std::vector{second.drive.id});
  EXPECT_EQ(ClaimJob(store_)->drives, std::vector{second.drive.id});
}

TEST_F(JobQueue, AMapIsBuiltFromChosenDrivesOfTheSite) {
  const ReceivedDrive other = Receive(store_, "elsewhere", {"b.bag", "garage", std::nullopt});
  const std::string id = received_.drive.id;

  EXPECT_EQ(QueueMap(store_, "lot", {}, false).drives, std::vector{id});
  EXPECT_EQ(QueueMap(store_, "lot", {id}, false).drives, std::vector{id});
  EXPECT_THROW(QueueMap(store_, "lot", {other.drive.id}, false), Error);
  EXPECT_THROW(QueueMap(store_, "lot", {id, id}, true), Error);
  EXPECT_THROW(QueueMap(store_, "nowhere", {}, false), Error);

  Receive(store_, "second", {"c.bag", "lot", std::nullopt});
  EXPECT_THROW(QueueMap(store_, "lot", {}, /*merge_drives=*/false), Error);
  EXPECT_EQ(QueueMap(store_, "lot", {}, /*merge_drives=*/true).drives.size(), 2u);
}

}  // namespace
}  // namespace parkade
