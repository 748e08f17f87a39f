#include "server/store/store.h"

#include "core/files/file.h"
#include "server/store/job_queue.h"
#include "server/store/publish_map.h"
#include "server/store/rig_store.h"
#include "server/store/tables/drive_table.h"
#include "tests/server/store/temporary_store.h"

namespace parkade {
namespace {

using ReconciledFiles = StoreTest;

// SQLite's quick_check runs at each start, over rows of every table.
TEST(Store, OpensAgainWithRowsInEveryTable) {
  const TemporaryRoot root;
  {
    Store store(root.path());
    const ReceivedDrive received = Receive(store, "a log", {"a.bag", "lot", std::nullopt});
    StoreRig(store, "car", {{"camchain-imucam.yaml", ""}, {"imu0.yaml", ""}, {"vehicle.yaml", ""}},
             nullptr);
    const Job job = *ClaimJob(store);
    const auto staging = store.directory.AttemptFolder(job.id, 1) / "out";
    WriteText(staging / "map.glb", "glTF");
    WriteText(staging / "report.json", "{}");
    PublishMap(store, job, *SealMap(staging));
  }
  Store store(root.path());
  for (const char* table :
       {"sites", "rigs", "drives", "jobs", "job_drives", "maps", "map_files", "map_drives"}) {
    const bool has_rows = store.database.Read([&](Connection& connection) {
      return connection.Query(std::string("SELECT 1 FROM ") + table).Step();
    });
    EXPECT_TRUE(has_rows) << table;
  }
}

TEST_F(ReconciledFiles, KeepWhatHasARow) {
  const ReceivedDrive received = Receive(store_, "a log", {"a.bag", "lot", std::nullopt});

  ReconcileFiles(store_);

  EXPECT_EQ(ReadFile(store_.directory.LogFile(received.drive.sha256)), "a log");
  EXPECT_TRUE(ContentOf(store_.directory.root() / "quarantine").empty());
}

TEST_F(ReconciledFiles, QuarantineWhatHasNone) {
  WriteText(store_.directory.LogsFolder() / "ab" / "abcd", "log");
  WriteText(store_.directory.MapsFolder() / "0123" / "map.glb", "map");
  WriteText(store_.directory.RigsFolder() / "0123" / "imu0.yaml", "rig");
  WriteText(store_.directory.JobsFolder() / "0123" / "attempt-1" / "log.txt", "job");

  ReconcileFiles(store_);

  size_t files = 0;
  for (const std::string& name : ContentOf(store_.directory.root() / "quarantine"))
    if (!name.ends_with('/')) ++files;
  EXPECT_EQ(files, 4u);
  EXPECT_TRUE(ContentOf(store_.directory.MapsFolder()).empty());
  EXPECT_TRUE(ContentOf(store_.directory.RigsFolder()).empty());
  EXPECT_TRUE(ContentOf(store_.directory.JobsFolder()).empty());
  EXPECT_EQ(ContentOf(store_.directory.LogsFolder()), std::set<std::string>{"ab/"});
}

TEST_F(ReconciledFiles, FinishADeletionThatWasCutShort) {
  const ReceivedDrive received = Receive(store_, "a log", {"a.bag", "lot", std::nullopt});
  store_.database.Write(
      [&](Connection& connection) { MarkDriveDeleted(connection, received.drive.id); });

  ReconcileFiles(store_);

  EXPECT_FALSE(std::filesystem::exists(store_.directory.LogFile(received.drive.sha256)));
}

TEST_F(ReconciledFiles, DropUnpublishedProductsAndKeepTheLog) {
  const ReceivedDrive received = Receive(store_, "a log", {"a.bag", "lot", std::nullopt});
  const auto attempt = store_.directory.AttemptFolder(received.job.id, 1);
  WriteText(attempt / "out" / "map.glb", "half a map");
  WriteText(attempt / "log.txt", "said");
  const auto worker = store_.directory.WorkerFolder(received.job.id);
  WriteText(worker / "attempt-1" / "tmp" / "parkade-unpacked-a" / "data.csv", "of an archive");
  WriteText(worker / "work" / "a" / "odometry.bin", "found");
  WriteText(store_.directory.PreviewFile(received.job.id, 1), "what it would have been");

  ReconcileFiles(store_);

  EXPECT_EQ(ContentOf(attempt), std::set<std::string>{"log.txt"});
  EXPECT_EQ(ContentOf(worker), (std::set<std::string>{"work/", "work/a/", "work/a/odometry.bin"}));
}

TEST_F(ReconciledFiles, LookAtJobsAgainThatEndedSince) {
  const ReceivedDrive received = Receive(store_, "a log", {"a.bag", "lot", std::nullopt});
  const auto attempt = store_.directory.AttemptFolder(received.job.id, 1);
  const auto end_at = [&](const std::string& time) {
    store_.database.Write([&](Connection& connection) {
      connection.Execute("UPDATE jobs SET state = 'done', finished_at = ?", time);
    });
    WriteText(attempt / "out" / "map.glb", "half a map");
  };
  end_at(UtcIn(-std::chrono::hours(24 * 30)));
  ReconcileFiles(store_);
  EXPECT_FALSE(std::filesystem::exists(attempt / "out")) << "what came before the first time";

  end_at(UtcIn(-std::chrono::hours(1)));
  ReconcileFiles(store_);
  EXPECT_FALSE(std::filesystem::exists(attempt / "out"));

  end_at(UtcIn(-std::chrono::hours(24 * 30)));
  store_.directory.NoteReconciled(std::chrono::system_clock::now() + std::chrono::hours(72));
  ReconcileFiles(store_);
  EXPECT_FALSE(std::filesystem::exists(attempt / "out")) << "the clock was wrong then";
}

}  // namespace
}  // namespace parkade
