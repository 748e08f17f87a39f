#include "server/store/store.h"

#include "core/file.h"
#include "server/store/drive_table.h"
#include "server/store/job_queue.h"
#include "tests/server/store/temporary_store.h"

namespace parkade {
namespace {

using ReconciledFiles = StoreTest;

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
  store_.database.Write([&](Connection& connection) { MarkDriveDeleted(connection, received.drive.id); });

  ReconcileFiles(store_);

  EXPECT_FALSE(std::filesystem::exists(store_.directory.LogFile(received.drive.sha256)));
}

TEST_F(ReconciledFiles, DropUnpublishedProductsAndKeepTheLog) {
  const ReceivedDrive received = Receive(store_, "a log", {"a.bag", "lot", std::nullopt});
  const auto attempt = store_.directory.AttemptFolder(received.job.id, 1);
  WriteText(attempt / "out" / "map.glb", "half a map");
  WriteText(attempt / "log.txt", "said");

  ReconcileFiles(store_);

  EXPECT_EQ(ContentOf(attempt), std::set<std::string>{"log.txt"});
}

}  // namespace
}  // namespace parkade
