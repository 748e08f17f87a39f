#include "server/store/publish_map.h"

#include "core/error.h"
#include "core/files/file.h"
#include "server/store/job_queue.h"
#include "server/store/tables/drive_table.h"
#include "server/store/tables/job_table.h"
#include "server/store/tables/map_table.h"
#include "server/store/tables/site_table.h"
#include "tests/server/store/temporary_store.h"

namespace parkade {
namespace {

class PublishedMap : public StoreTest {
 protected:
  std::filesystem::path Stage() {
    const auto staging = store_.directory.AttemptFolder(received_.job.id, 1) / "out";
    WriteText(staging / "map.glb", "glTF");
    WriteText(staging / "tiles" / "0.glb", "tile");
    WriteText(staging / "report.json",
              R"({"datum": {"latitude_deg": 48.1, "longitude_deg": 11.5, "altitude": 500},
      "bounds": {"min": [0, 0, 0], "max": [1, 1, 1]}, "drives": [{"name": "a", "streams": [{"topic": "/imu"}]}]})");
    return staging;
  }
  void ExpectNothingPublished() {
    EXPECT_TRUE(ContentOf(store_.directory.MapsFolder()).empty());
    EXPECT_THROW(store_.database.Read(
                     [](Connection& connection) { return LatestMapVersion(connection, "lot"); }),
                 Error);
  }

  ReceivedDrive received_ = Receive(store_, "a log", {"a.bag", "lot", std::nullopt});
  Job job_ = *ClaimJob(store_);
};

TEST_F(PublishedMap, HasAManifestOfItsFiles) {
  const auto staging = Stage();
  const MapVersion map = PublishMap(store_, job_, *SealMap(staging));

  EXPECT_EQ(map.version, 1);
  ASSERT_EQ(map.files.size(), 3u);
  EXPECT_EQ(map.files[0].name, "map.glb");
  EXPECT_EQ(map.files[0].bytes, 4);
  EXPECT_EQ(map.files[0].sha256, Sha256Of("glTF"));
  EXPECT_EQ(map.files[2].name, "tiles/0.glb");
  EXPECT_EQ(ReadFile(store_.directory.MapFolder(map.id) / "tiles" / "0.glb"), "tile");
  EXPECT_FALSE(std::filesystem::exists(staging));
}

TEST_F(PublishedMap, EndsTheJobAndMakesTheDriveReady) {
  PublishMap(store_, job_, *SealMap(Stage()));

  const auto [job, drive, site] = store_.database.Read([&](Connection& connection) {
    return std::tuple(FindJob(connection, job_.id), FindDrive(connection, received_.drive.id),
                      FindSite(connection, "lot"));
  });
  EXPECT_EQ(job.state, JobState::kDone);
  EXPECT_EQ(job.map_version, 1);
  EXPECT_EQ(drive.state, DriveState::kReady);
  EXPECT_EQ(drive.map_version, 1);
  EXPECT_EQ(drive.streams, R"([{"topic":"/imu"}])");
  EXPECT_EQ(site.versions, std::vector<std::int64_t>{1});
  EXPECT_NE(site.datum->find("48.1"), std::string::npos);
}

TEST_F(PublishedMap, VersionsCountUpPerSite) {
  PublishMap(store_, job_, *SealMap(Stage()));
  QueueMap(store_, "lot", {}, false);
  const Job again = *ClaimJob(store_);

  EXPECT_EQ(PublishMap(store_, again, *SealMap(Stage())).version, 2);
}

TEST_F(PublishedMap, ADriveThatTheWorkerLeftOutFailsWithTheReason) {
  Receive(store_, "another log", {"b.bag", "lot", std::nullopt});
  PublishMap(store_, job_, *SealMap(Stage()));
  ClaimJob(store_);  // of b alone
  const Job both = (QueueMap(store_, "lot", {}, true), *ClaimJob(store_));
  const auto staging = store_.directory.AttemptFolder(both.id, 1) / "out";
  WriteText(staging / "map.glb", "glTF");
  WriteText(staging / "report.json",
            R"({"left_out": [{"name": "b", "reason": "no places in common"}]})");
  const MapVersion map = PublishMap(store_, both, *SealMap(staging));

  ASSERT_EQ(map.drives.size(), 1u);
  EXPECT_EQ(map.drives[0].name, "a");
  const Drive left_out = store_.database.Read(
      [&](Connection& connection) { return FindDrive(connection, both.drives[1]); });
  EXPECT_EQ(left_out.state, DriveState::kFailed);
  EXPECT_EQ(left_out.error, "left out of version 2: no places in common");
}

TEST_F(PublishedMap, ADriveStaysReadyWhenALaterJobFails) {
  PublishMap(store_, job_, *SealMap(Stage()));
  QueueMap(store_, "lot", {}, false);
  FailJob(store_, *ClaimJob(store_), "internal", "no luck");

  const Drive drive = store_.database.Read(
      [&](Connection& connection) { return FindDrive(connection, received_.drive.id); });
  EXPECT_EQ(drive.state, DriveState::kReady);
}

TEST_F(PublishedMap, KeepsItsDriveReadyWhileALaterJobWaitsAndRuns) {
  PublishMap(store_, job_, *SealMap(Stage()));
  const auto drive_now = [&] {
    return store_.database.Read(
        [&](Connection& connection) { return FindDrive(connection, received_.drive.id); });
  };

  QueueMap(store_, "lot", {}, false);
  EXPECT_EQ(drive_now().state, DriveState::kReady);
  const Job again = *ClaimJob(store_);
  EXPECT_EQ(drive_now().state, DriveState::kReady);
  EXPECT_THROW(DeleteDrive(store_, received_.drive.id), Error) << "a job that runs uses it";
  ReturnJob(store_, again);
  EXPECT_EQ(drive_now().state, DriveState::kReady);

  DeleteDrive(store_, received_.drive.id);
  EXPECT_TRUE(ClaimJob(store_)->drives.empty()) << "a job that waits does without it";
}

TEST_F(PublishedMap, IsWhereAReviewStarts) {
  PublishMap(store_, job_, *SealMap(Stage()));
  const MapReview review{1, {"17-140", "18-141"}, {"a:3-90"}, {"a:3~b:7"}, {"a:4~b:8"}};

  QueueMap(store_, "lot", {}, false, review);
  const Job again = *ClaimJob(store_);

  EXPECT_EQ(again.drives, std::vector{received_.drive.id}) << "those of the version";
  EXPECT_EQ(again.review.from_version, 1);
  EXPECT_EQ(again.review.rejected_loops, review.rejected_loops);
  EXPECT_EQ(again.review.forced_loops, review.forced_loops);
  EXPECT_EQ(again.review.rejected_links, review.rejected_links);
  EXPECT_EQ(again.review.forced_links, review.forced_links);
  EXPECT_THROW(QueueMap(store_, "lot", {}, false, {.from_version = 7}), Error);
}

TEST_F(PublishedMap, IsReviewedWithoutTheDrivesThatWereDeleted) {
  Receive(store_, "another log", {"b.bag", "lot", std::nullopt});
  PublishMap(store_, job_, *SealMap(Stage()));
  FinishCancelledJob(store_, *ClaimJob(store_));  // of b alone
  const Job both = (QueueMap(store_, "lot", {}, true), *ClaimJob(store_));
  const auto [a, b] = std::pair(both.drives.at(0), both.drives.at(1));
  PublishMap(store_, both, *SealMap(Stage()));
  DeleteDrive(store_, a);

  const Job review = QueueMap(store_, "lot", {}, true, {.from_version = 2});
  EXPECT_EQ(review.drives, std::vector{b});
  EXPECT_THROW(QueueMap(store_, "lot", {a}, true, {.from_version = 2}), Error)
      << "named by the caller";

  CancelWaitingJob(store_, review.id);
  DeleteDrive(store_, b);
  try {
    QueueMap(store_, "lot", {}, true, {.from_version = 2});
    FAIL() << "queued";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kConflict);
    EXPECT_STREQ(error.what(), "all drives of version 2 were deleted");
  }
}

TEST_F(PublishedMap, NeedsAMeshAndAReport) {
  const auto staging = Stage();
  std::filesystem::remove(staging / "map.glb");

  EXPECT_THROW(PublishMap(store_, job_, *SealMap(staging)), Error);
  ExpectNothingPublished();
}

TEST_F(PublishedMap, TakesNoLinksOutOfTheFolder) {
  const auto staging = Stage();
  std::filesystem::create_symlink("/etc/passwd", staging / "ground.ply");

  EXPECT_THROW(PublishMap(store_, job_, *SealMap(staging)), Error);
  ExpectNothingPublished();
}

TEST_F(PublishedMap, IsSealedWhileSomebodyWantsIt) {
  const auto staging = Stage();

  EXPECT_FALSE(SealMap(staging, [] { return false; }).has_value());
  EXPECT_TRUE(SealMap(staging).has_value()) << "a seal that was broken off can be made again";
  ExpectNothingPublished();
}

TEST_F(PublishedMap, IsNotPublishedByAnAttemptThatWasGivenUp) {
  RetryCrashedJob(store_, job_, "crashed", "lost", {});
  ClaimJob(store_);

  EXPECT_THROW(PublishMap(store_, job_, *SealMap(Stage())), Error);
  ExpectNothingPublished();
}

TEST_F(PublishedMap, NeedsAReportThatIsJson) {
  const auto staging = Stage();
  WriteText(staging / "report.json", "{\"datum\": ");

  EXPECT_THROW(PublishMap(store_, job_, *SealMap(staging)), Error);
  ExpectNothingPublished();
}

}  // namespace
}  // namespace parkade
