// Drives that come to a site one after the other, and what a job joins them with.

#include "core/error.h"
#include "server/store/job_queue.h"
#include "server/store/publish_map.h"
#include "server/store/tables/drive_table.h"
#include "server/store/tables/job_table.h"
#include "server/store/tables/map_table.h"
#include "tests/server/store/temporary_store.h"

namespace parkade {
namespace {

/// A site whose uploads are joined.
class GrowingSite : public StoreTest {
 protected:
  ReceivedDrive Upload(const std::string& name) {
    return Receive(store_, "log " + name, {name + ".bag", "lot", std::nullopt},
                   /*merge_drives=*/true);
  }
  void Publish(const Job& job) {
    const auto out = store_.directory.AttemptFolder(job.id, job.attempt) / "out";
    WriteText(out / "map.glb", "glTF");
    WriteText(out / "report.json", "{}");
    PublishMap(store_, job, *SealMap(out));
  }
  void CrashThreeTimes(const std::string& job) {
    for (int attempt = 1; attempt <= 3; ++attempt) {
      const Job claimed = *ClaimJob(store_);
      ASSERT_EQ(claimed.id, job);
      Crash(claimed);
    }
  }
  void Crash(const Job& job) { RetryCrashedJob(store_, job, "crashed", "segmentation fault", {}); }
  Job JobOf(const ReceivedDrive& received) {
    return store_.database.Read(
        [&](Connection& connection) { return FindJob(connection, received.job.id); });
  }
  DriveState StateOf(const ReceivedDrive& received) {
    return store_.database.Read(
        [&](Connection& connection) { return FindDrive(connection, received.drive.id).state; });
  }
};

TEST_F(GrowingSite, IsJoinedAsItIsWhenTheJobStarts) {
  const ReceivedDrive a = Upload("a"), b = Upload("b"), c = Upload("c");

  const Job first = *ClaimJob(store_);
  EXPECT_EQ(first.drives, std::vector{a.drive.id}) << "b and c wait for jobs of their own";
  Publish(first);
  CrashThreeTimes(b.job.id);
  EXPECT_EQ(StateOf(a), DriveState::kReady);
  EXPECT_EQ(StateOf(b), DriveState::kFailed);

  const Job third = *ClaimJob(store_);
  EXPECT_EQ(third.drives, (std::vector{a.drive.id, c.drive.id}));
  EXPECT_EQ(
      store_.database.Read([&](Connection& connection) { return FindJob(connection, c.job.id); })
          .drives,
      third.drives);
}

TEST_F(GrowingSite, IsJoinedWithoutADriveWhoseJobWasCancelled) {
  const ReceivedDrive a = Upload("a"), b = Upload("b"), c = Upload("c");
  Publish(*ClaimJob(store_));
  CancelWaitingJob(store_, b.job.id);

  EXPECT_EQ(ClaimJob(store_)->drives, (std::vector{a.drive.id, c.drive.id}));
}

TEST_F(GrowingSite, IsJoinedByAJobThatIsTriedAgain) {
  const ReceivedDrive a = Upload("a");
  FailJob(store_, *ClaimJob(store_), "invalid_input", "no luck");
  const ReceivedDrive b = Upload("b");
  Publish(*ClaimJob(store_));

  EXPECT_EQ(RetryJob(store_, a.job.id).drives, std::vector{a.drive.id});
  const Job again = *ClaimJob(store_);
  EXPECT_EQ(again.drives, (std::vector{a.drive.id, b.drive.id}));
  Publish(again);
  const MapVersion latest =
      store_.database.Read([&](Connection& connection) { return FindMap(connection, "lot", 2); });
  EXPECT_EQ(latest.drives.size(), 2u);
}

TEST_F(GrowingSite, IsJoinedByOneJobAfterTheOther) {
  const ReceivedDrive a = Upload("a"), b = Upload("b");
  const ReceivedDrive elsewhere =
      Receive(store_, "other", {"other.bag", "garage", std::nullopt}, true);

  const Job first = *ClaimJob(store_);
  EXPECT_EQ(ClaimJob(store_)->id, elsewhere.job.id)
      << "another worker does not wait for another site";
  EXPECT_FALSE(ClaimJob(store_).has_value());
  EXPECT_EQ(StateOf(b), DriveState::kQueued);
  Publish(first);

  EXPECT_EQ(ClaimJob(store_)->drives, (std::vector{a.drive.id, b.drive.id}));
}

TEST_F(GrowingSite, IsJoinedAnewAfterACrash) {
  const ReceivedDrive a = Upload("a"), b = Upload("b");
  Publish(*ClaimJob(store_));
  const Job second = *ClaimJob(store_);
  EXPECT_EQ(second.drives, (std::vector{a.drive.id, b.drive.id}));

  Crash(second);
  EXPECT_EQ(StateOf(a), DriveState::kReady);
  EXPECT_EQ(StateOf(b), DriveState::kQueued);
  DeleteDrive(store_, a.drive.id);

  EXPECT_EQ(ClaimJob(store_)->drives, std::vector{b.drive.id});
}

TEST_F(GrowingSite, IsNotMappedAnewForADriveThatWasDeleted) {
  const ReceivedDrive a = Upload("a"), b = Upload("b");
  Publish(*ClaimJob(store_));
  CancelWaitingJob(store_, b.job.id);
  DeleteDrive(store_, b.drive.id);

  EXPECT_THROW(RetryJob(store_, b.job.id), Error);
  EXPECT_FALSE(ClaimJob(store_).has_value());
  EXPECT_EQ(StateOf(a), DriveState::kReady);
}

TEST_F(GrowingSite, TakesTheNewDriveOfEqualLogs) {
  const ReceivedDrive a = Upload("a");
  FailJob(store_, *ClaimJob(store_), "internal", "no luck");
  const ReceivedDrive copy =
      Receive(store_, "log a", {"copy.bag", "lot", std::nullopt}, /*merge_drives=*/true);
  Publish(*ClaimJob(store_));
  RetryJob(store_, a.job.id);

  EXPECT_EQ(ClaimJob(store_)->drives, std::vector{a.drive.id});
  EXPECT_EQ(StateOf(copy), DriveState::kReady);
}

TEST_F(GrowingSite, TakesInWhatWaitsBesideWhereAskedTo) {
  const ReceivedDrive a = Upload("a");
  Publish(*ClaimJob(store_));
  const ReceivedDrive b = Upload("b"), c = Upload("c");

  const Job job = *ClaimJob(store_, /*takes_neighbors=*/true);
  EXPECT_EQ(job.id, b.job.id);
  EXPECT_EQ(job.drives, (std::vector{a.drive.id, b.drive.id, c.drive.id}));
  EXPECT_FALSE(ClaimJob(store_, true).has_value());
  Publish(job);

  EXPECT_EQ(StateOf(c), DriveState::kReady);
  const Job neighbor = JobOf(c);
  EXPECT_EQ(neighbor.state, JobState::kDone);
  EXPECT_EQ(neighbor.map_version, 2);
  EXPECT_EQ(neighbor.started_at, JobOf(b).started_at);
  EXPECT_FALSE(ClaimJob(store_, true).has_value()) << "nothing is left to do";
}

TEST_F(GrowingSite, GoesOnAloneWhereANeighborMayBeTheReasonOfAFailure) {
  const ReceivedDrive a = Upload("a"), b = Upload("b");
  FailJob(store_, *ClaimJob(store_, true), "out_of_memory", "too much");
  EXPECT_EQ(JobOf(a).state, JobState::kQueued);

  const Job alone = *ClaimJob(store_, true);
  EXPECT_EQ(alone.id, a.job.id);
  EXPECT_EQ(alone.drives, std::vector{a.drive.id});
  FailJob(store_, alone, "out_of_memory", "too much");
  EXPECT_EQ(JobOf(a).state, JobState::kFailed);
  EXPECT_EQ(StateOf(a), DriveState::kFailed);

  EXPECT_EQ(ClaimJob(store_, true)->drives, std::vector{b.drive.id});
}

TEST_F(GrowingSite, GoesOnAloneAfterACrash) {
  const ReceivedDrive a = Upload("a"), b = Upload("b");
  Crash(*ClaimJob(store_, true));

  EXPECT_EQ(ClaimJob(store_, true)->drives, std::vector{a.drive.id});
  EXPECT_EQ(JobOf(b).state, JobState::kQueued);
}

TEST_F(GrowingSite, LeavesOutNeighborsWhoseJobsWereCancelledOrHaveTheSameLog) {
  const ReceivedDrive a = Upload("a"), b = Upload("b");
  const ReceivedDrive copy = Receive(store_, "log a", {"copy.bag", "lot", std::nullopt}, true);
  CancelWaitingJob(store_, b.job.id);

  EXPECT_EQ(ClaimJob(store_, true)->drives, std::vector{a.drive.id});
  EXPECT_EQ(JobOf(copy).state, JobState::kQueued);
}

}  // namespace
}  // namespace parkade
