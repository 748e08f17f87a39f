#include "server/store/care/retention.h"

#include <thread>

#include "core/error.h"
#include "core/files/file.h"
#include "server/store/care/backup.h"
#include "server/store/review/review.h"
#include "server/store/review/site_settings.h"
#include "server/store/tables/check_table.h"
#include "server/store/tables/drive_table.h"
#include "tests/server/store/review/published_site.h"

namespace parkade {
namespace {

using namespace std::chrono_literals;
using Days = std::chrono::days;

class Retention : public PublishedSite {
 protected:
  void Keep(std::optional<std::int64_t> log_days, std::optional<std::int64_t> map_days,
            const std::string& site = "lot") {
    ChangeSite(store_, site, {.log_days = {log_days}, .map_days = {map_days}});
  }
  Expired DeleteIn(int days) {
    return DeleteExpired(store_, std::chrono::system_clock::now() + Days(days));
  }
  Drive DriveNow(const std::string& id) {
    return store_.database.Read([&](Connection& connection) { return FindDrive(connection, id); });
  }
  bool HasLog(const Drive& drive) {
    return std::filesystem::exists(store_.directory.LogFile(drive.sha256));
  }
  bool HasFiles(const MapVersion& map) {
    return std::filesystem::exists(store_.directory.MapFolder(map.id));
  }
  void ExpectWhole() { EXPECT_TRUE(VerifyData(store_.directory.root(), true).damaged.empty()); }
  void Decide(std::int64_t version, const std::string& action) {
    ReviewVersion(store_, "lot", version, {action, "because", {}}, "ann");
  }
};

TEST_F(Retention, KeepsEverythingForEverUnlessToldOtherwise) {
  const Expired expired = DeleteIn(36'500);
  EXPECT_TRUE(expired.drives.empty() && expired.maps.empty());
  EXPECT_TRUE(HasLog(received_.drive));
}

TEST_F(Retention, DeletesLogsWhoseTimeIsOver) {
  Keep(90, std::nullopt);
  EXPECT_TRUE(DeleteIn(89).drives.empty());
  EXPECT_TRUE(HasLog(received_.drive));

  EXPECT_EQ(DeleteIn(91).drives, std::vector{received_.drive.id});
  EXPECT_FALSE(HasLog(received_.drive));
  EXPECT_TRUE(DriveNow(received_.drive.id).log_deleted_at.has_value()) << "the drive says so";
  EXPECT_EQ(ReadFile(store_.directory.MapFolder(map_.id) / "map.glb").substr(0, 4), "glTF");
  ExpectWhole();
  EXPECT_TRUE(DeleteIn(91).drives.empty()) << "once";
}

TEST_F(Retention, KeepsAnEqualLogThatIsYoungerOrKeptElsewhere) {
  const ReceivedDrive elsewhere = Receive(store_, "a log", {"b.bag", "street", std::nullopt});
  CancelWaitingJob(store_, elsewhere.job.id);
  Keep(90, std::nullopt);
  DeleteIn(91);
  EXPECT_TRUE(HasLog(received_.drive)) << "the other site keeps it";
  ExpectWhole();

  Keep(90, std::nullopt, "street");
  DeleteIn(91);
  EXPECT_FALSE(HasLog(received_.drive));
  ExpectWhole();
}

TEST_F(Retention, KeepsLogsThatJobsNeed) {
  Keep(1, std::nullopt);
  const Job waiting = QueueMap(store_, "lot", {}, true);
  EXPECT_TRUE(DeleteIn(2).drives.empty());
  const Job running = *ClaimJob(store_);
  EXPECT_TRUE(DeleteIn(2).drives.empty());
  FailJob(store_, running, "internal", "no luck");
  EXPECT_EQ(DeleteIn(2).drives.size(), 1u);

  const Error error = ErrorOf([&] { RetryJob(store_, waiting.id); });
  EXPECT_EQ(error.code(), ErrorCode::kConflict);
  EXPECT_NE(std::string(error.what()).find("the log of drive 'a' was deleted on "),
            std::string::npos)
      << error.what();
}

TEST_F(Retention, JobsThatNeedTheLogSaySo) {
  Keep(1, std::nullopt);
  DeleteIn(2);
  const std::string id = received_.drive.id;
  for (const auto& [drives, review] :
       {std::pair(std::vector{id}, MapReview{}),
        std::pair(std::vector<std::string>{}, MapReview{.from_version = 1}),
        std::pair(std::vector{id}, MapReview{.from_version = 1})}) {
    const Error error = ErrorOf([&] { QueueMap(store_, "lot", drives, true, review); });
    EXPECT_EQ(error.code(), ErrorCode::kConflict);
    EXPECT_NE(std::string(error.what()).find("upload it again"), std::string::npos);
  }
  EXPECT_EQ(ErrorOf([&] { QueueMap(store_, "lot", {}, true); }).code(), ErrorCode::kInvalidInput);
}

TEST_F(Retention, ANewDriveIsJoinedWithThoseThatHaveTheirLogs) {
  Keep(1, std::nullopt);
  DeleteIn(2);
  const ReceivedDrive next =
      Receive(store_, "another log", {"b.bag", "lot", std::nullopt}, /*merge_drives=*/true);

  EXPECT_EQ(ClaimJob(store_)->drives, std::vector{next.drive.id});
}

TEST_F(Retention, TheLogUploadedAgainIsThereAgain) {
  Keep(1, std::nullopt);
  DeleteIn(2);
  const ReceivedDrive again = Receive(store_, "a log", {"a.bag", "lot", std::nullopt});

  EXPECT_TRUE(HasLog(again.drive));
  EXPECT_TRUE(DriveNow(received_.drive.id).log_deleted_at.has_value());
  ExpectWhole();
  CancelWaitingJob(store_, again.job.id);
  DeleteDrive(store_, again.drive.id);
  EXPECT_FALSE(HasLog(again.drive)) << "the old drive holds nothing";
}

TEST_F(Retention, ADriveWithoutItsLogCanBeDeleted) {
  Keep(1, std::nullopt);
  const MapVersion second = PublishAgain();
  DeleteIn(2);
  DeleteDrive(store_, received_.drive.id);

  const Error error = ErrorOf([&] { QueueMap(store_, "lot", {}, true, {.from_version = 2}); });
  EXPECT_STREQ(error.what(), "all drives of version 2 were deleted");
}

TEST_F(Retention, DeletesFilesOfOldVersionsButNotTheNewestNorAnApprovedOne) {
  const MapVersion second = PublishAgain(), third = PublishAgain(), newest = PublishAgain();
  Decide(2, "submit");
  Decide(2, "approve");
  Decide(3, "submit");
  Decide(3, "reject");
  Keep(std::nullopt, 30);
  EXPECT_TRUE(DeleteIn(29).maps.empty());
  store_.database.Write([&](Connection& connection) {
    SetFileCheck(connection, "maps/" + map_.id + "/map.glb", "is missing");
  });

  const std::vector<std::pair<std::string, std::int64_t>> expected = {{"lot", 1}, {"lot", 3}};
  EXPECT_EQ(DeleteIn(31).maps, expected);
  EXPECT_FALSE(HasFiles(map_) || HasFiles(third));
  EXPECT_TRUE(HasFiles(second) && HasFiles(newest) && HasLog(received_.drive));
  EXPECT_TRUE(Version(1).files.empty());
  EXPECT_TRUE(Version(1).files_deleted_at.has_value());
  EXPECT_EQ(Version(3).review_state, ReviewState::kRejected) << "its history stays";
  EXPECT_EQ(store_.database.Read(CountDamagedFiles), 0) << "what is gone is not damaged";
  ExpectWhole();
}

TEST_F(Retention, AVersionWithoutItsFilesIsNeitherDecidedOnNorBuiltFrom) {
  PublishAgain();
  Keep(std::nullopt, 1);
  DeleteIn(2);

  EXPECT_EQ(ErrorOf([&] { Decide(1, "submit"); }).code(), ErrorCode::kConflict);
  const Error error = ErrorOf([&] { QueueMap(store_, "lot", {}, true, {.from_version = 1}); });
  EXPECT_NE(std::string(error.what()).find("the files of version 1 were deleted on "),
            std::string::npos)
      << error.what();
}

TEST_F(Retention, KeepsVersionsThatJobsReadFrom) {
  PublishAgain();
  Keep(std::nullopt, 1);
  QueueMap(store_, "lot", {}, true, {.from_version = 1});
  EXPECT_TRUE(DeleteIn(2).maps.empty()) << "a job waits for it";
  const Job job = *ClaimJob(store_);
  EXPECT_TRUE(DeleteIn(2).maps.empty()) << "a job may read there";
  FinishCancelledJob(store_, job);
  EXPECT_EQ(DeleteIn(2).maps.size(), 1u);
}

TEST_F(Retention, DeletesComparisonsOfTheVersion) {
  const MapVersion second = PublishAgain();
  const auto folder = store_.directory.ComparisonFolder(map_.id, second.id);
  WriteText(folder / "changes.png", "PNG");
  Keep(std::nullopt, 1);
  DeleteIn(2);
  EXPECT_FALSE(std::filesystem::exists(folder));
}

TEST_F(Retention, WhatACrashLeftIsDeletedAtTheNextStart) {
  PublishAgain();
  Keep(1, 1);
  const auto log = store_.directory.LogFile(received_.drive.sha256);
  const auto mesh = store_.directory.MapFolder(map_.id) / "map.glb";
  DeleteIn(2);
  // As after a crash between the commit and the deletion of the files.
  WriteText(log, "a log");
  WriteText(mesh, "glTF");
  ReconcileFiles(store_);

  EXPECT_FALSE(std::filesystem::exists(log));
  EXPECT_FALSE(std::filesystem::exists(mesh.parent_path()));
  EXPECT_TRUE(ContentOf(store_.directory.root() / "quarantine").empty())
      << "deleted, not put aside";
}

TEST_F(Retention, IsKeptByAThreadOfItsOwn) {
  Keep(90, std::nullopt);
  std::atomic<int> days = 0, num_deleted = 0, num_rounds = 0;
  {
    const RetentionKeeper keeper(
        store_, 1ms,
        [&](const Expired& expired) {
          num_deleted += static_cast<int>(expired.drives.size());
          ++num_rounds;
        },
        [&] { return std::chrono::system_clock::now() + Days(days); });
    while (num_rounds < 3) std::this_thread::sleep_for(1ms);
    EXPECT_TRUE(HasLog(received_.drive));
    days = 91;
    for (int i = 0; i < 3000 && num_deleted == 0; ++i) std::this_thread::sleep_for(10ms);
  }
  EXPECT_EQ(num_deleted, 1);
  EXPECT_FALSE(HasLog(received_.drive));
}

}  // namespace
}  // namespace parkade
