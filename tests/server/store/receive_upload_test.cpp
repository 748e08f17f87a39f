#include "server/store/receive_upload.h"

#include "core/error.h"
#include "core/files/file.h"
#include "server/store/job_queue.h"
#include "server/store/tables/drive_table.h"
#include "server/store/tables/job_table.h"
#include "tests/server/store/temporary_store.h"

namespace parkade {
namespace {

class Intake : public StoreTest {
 protected:
  /// Ends a running job as if its map had been published.
  void MakeReady(const Job& job) {
    FinishCancelledJob(store_, job);
    store_.database.Write([&](Connection& connection) {
      for (const std::string& drive : job.drives)
        SetDriveState(connection, drive, DriveState::kReady, std::nullopt);
    });
  }
};

std::vector<Drive> AllDrives(Store& store) {
  return store.database.Read(
      [](Connection& connection) { return ListDrives(connection, {}, std::nullopt); });
}

TEST_F(Intake, AReceivedDriveIsQueuedWithItsJob) {
  const ReceivedDrive received =
      Receive(store_, "a log", {"Level 2.bag", std::nullopt, std::nullopt});

  EXPECT_EQ(received.drive.name, "Level-2");
  EXPECT_EQ(received.drive.site, "Level-2");
  EXPECT_EQ(received.drive.filename, "Level 2.bag");
  EXPECT_EQ(received.drive.state, DriveState::kQueued);
  EXPECT_EQ(received.drive.job, received.job.id);
  EXPECT_EQ(received.job.drives, std::vector{received.drive.id});
  EXPECT_EQ(ReadFile(store_.directory.LogFile(received.drive.sha256)), "a log");
}

TEST_F(Intake, ADriveWithoutASiteGetsOneOfItsOwn) {
  const ReceivedDrive first = Receive(store_, "a log", {"lot.bag", std::nullopt, std::nullopt});
  const ReceivedDrive second = Receive(store_, "another", {"lot.bag", std::nullopt, std::nullopt});
  const ReceivedDrive third = Receive(store_, "a third", {"lot.bag", "lot", std::nullopt});

  EXPECT_EQ(first.drive.site, "lot");
  EXPECT_EQ(second.drive.site, "lot-2");
  EXPECT_EQ(third.drive.site, "lot");
  EXPECT_EQ(third.drive.name, "lot-2") << "a drive's name is its folder in the site's maps";
}

TEST_F(Intake, MergingJobsMapAllDrivesOfTheSite) {
  const ReceivedDrive first = Receive(store_, "a log", {"a.bag", "lot", std::nullopt});
  const ReceivedDrive second =
      Receive(store_, "b", {"b.bag", "lot", std::nullopt}, /*merge_drives=*/true);

  EXPECT_EQ(second.job.drives, std::vector{second.drive.id}) << "others are known once it starts";
  MakeReady(*ClaimJob(store_));
  EXPECT_EQ(ClaimJob(store_)->drives, (std::vector{first.drive.id, second.drive.id}));
}

TEST_F(Intake, MergingJobsMapEqualLogsOnce) {
  Receive(store_, "the same", {"a.bag", "lot", std::nullopt});
  const ReceivedDrive second =
      Receive(store_, "the same", {"b.bag", "lot", std::nullopt}, /*merge_drives=*/true);

  MakeReady(*ClaimJob(store_));
  EXPECT_EQ(ClaimJob(store_)->drives, std::vector{second.drive.id});
}

TEST_F(Intake, MergingJobsKeepALogWhoseLaterCopyIsNotUsable) {
  const ReceivedDrive first = Receive(store_, "the same", {"a.bag", "lot", std::nullopt});
  const ReceivedDrive cancelled =
      Receive(store_, "the same", {"b.bag", "lot", std::nullopt}, /*merge_drives=*/true);
  CancelWaitingJob(store_, cancelled.job.id);
  const ReceivedDrive third =
      Receive(store_, "another", {"c.bag", "lot", std::nullopt}, /*merge_drives=*/true);

  MakeReady(*ClaimJob(store_));
  EXPECT_EQ(ClaimJob(store_)->drives, (std::vector{first.drive.id, third.drive.id}));
}

TEST_F(Intake, MergingJobsLeaveDrivesOutThatFailed) {
  Receive(store_, "a log", {"a.bag", "lot", std::nullopt});
  FailJob(store_, *ClaimJob(store_), "invalid_input", "no IMU");
  const ReceivedDrive second =
      Receive(store_, "b", {"b.bag", "lot", std::nullopt}, /*merge_drives=*/true);

  EXPECT_EQ(ClaimJob(store_)->drives, std::vector{second.drive.id});
}

TEST_F(Intake, EqualLogsAreStoredOnceAndDeletedWithTheLastDrive) {
  const ReceivedDrive first = Receive(store_, "the same", {"a.bag", "lot", std::nullopt});
  const ReceivedDrive second = Receive(store_, "the same", {"b.bag", "lot", std::nullopt});
  const auto log = store_.directory.LogFile(first.drive.sha256);
  EXPECT_EQ(first.drive.sha256, second.drive.sha256);
  CancelWaitingJob(store_, first.job.id);
  CancelWaitingJob(store_, second.job.id);

  DeleteDrive(store_, first.drive.id);
  EXPECT_TRUE(std::filesystem::exists(log));
  DeleteDrive(store_, second.drive.id);
  EXPECT_FALSE(std::filesystem::exists(log));
  EXPECT_TRUE(AllDrives(store_).empty());
}

TEST_F(Intake, ADriveInUseIsNotDeleted) {
  const ReceivedDrive received = Receive(store_, "a log", {"a.bag", "lot", std::nullopt});
  try {
    DeleteDrive(store_, received.drive.id);
    FAIL() << "deleted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kConflict);
    EXPECT_NE(std::string(error.what()).find(received.job.id), std::string::npos);
  }
  EXPECT_EQ(AllDrives(store_).size(), 1u);
}

TEST_F(Intake, NamesAndRigAreCheckedBeforehand) {
  EXPECT_NO_THROW(
      CheckNewDrive(store_, {"any name at all \xf0\x9f\x9a\x97.bag", "lot", std::nullopt}));
  EXPECT_THROW(CheckNewDrive(store_, {"a.bag", "../lot", std::nullopt}), Error);
  EXPECT_THROW(CheckNewDrive(store_, {"a.bag", "lot", "no-such-rig"}), Error);
  EXPECT_THROW(CheckNewDrive(store_, {"a\nb.bag", "lot", std::nullopt}), Error);
  EXPECT_THROW(CheckNewDrive(store_, {std::string(256, 'a'), "lot", std::nullopt}), Error);
}

TEST_F(Intake, SpaceIsCheckedBesideTheReserve) {
  EXPECT_THROW(RequireSpace(store_, std::int64_t{1} << 60), Error);
  store_.disk_reserve = 0;
  EXPECT_NO_THROW(RequireSpace(store_, 1));
  store_.disk_reserve = std::int64_t{1} << 60;
  EXPECT_THROW(RequireSpace(store_, 1), Error);
}

TEST_F(Intake, ListsPageFromTheNewest) {
  for (int i = 0; i < 5; ++i)
    Receive(store_, std::to_string(i), {std::to_string(i) + ".bag", "lot", std::nullopt});

  const auto page = [&](std::int64_t before) {
    return store_.database.Read([&](Connection& connection) {
      return ListDrives(connection, {.limit = 2, .before = before}, "lot");
    });
  };
  const std::vector<Drive> first = page(Page{}.before), second = page(first.back().sequence),
                           third = page(second.back().sequence);
  ASSERT_EQ(first.size() + second.size() + third.size(), 5u);
  EXPECT_EQ(first[0].name, "4");
  EXPECT_EQ(second[0].name, "2");
  EXPECT_EQ(third[0].name, "0");
}

}  // namespace
}  // namespace parkade
