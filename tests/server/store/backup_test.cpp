#include "server/store/care/backup.h"

#include <atomic>
#include <thread>

#include "core/files/file.h"
#include "server/store/job_queue.h"
#include "server/store/publish_map.h"
#include "server/store/rig_store.h"
#include "server/store/tables/drive_table.h"
#include "server/store/tables/map_table.h"
#include "tests/server/store/temporary_store.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

class Backup : public StoreTest {
 protected:
  /// A drive with its map; returns the drive's id.
  std::string MapOne(const std::string& content) {
    const std::string drive = Receive(store_, content, {"a.bag", "lot", std::nullopt}).drive.id;
    const Job job = *ClaimJob(store_);
    const fs::path staging = store_.directory.AttemptFolder(job.id, 1) / "out";
    WriteText(staging / "map.glb", "glTF of " + content);
    WriteText(staging / "report.json", "{}");
    WriteText(staging.parent_path() / "log.txt", "worked");
    PublishMap(store_, job, *SealMap(staging));
    return drive;
  }
  void AddRig() {
    StoreRig(store_, "car",
             {{"camchain-imucam.yaml", "a"}, {"imu0.yaml", "b"}, {"vehicle.yaml", "c"}}, nullptr);
  }
  static void Rot(const fs::path& file) {
    fs::permissions(file, fs::perms::owner_write, fs::perm_options::add);
    std::fstream(file, std::ios::in | std::ios::out | std::ios::binary).put('\x02');
  }

  fs::path data_ = root_.path() / "data", backup_ = root_.path() / "backup",
           restored_ = root_.path() / "restored";
};

TEST_F(Backup, IsADataDirectoryOfTheSameContent) {
  const std::string drive = MapOne("log one");
  AddRig();
  Receive(store_, "log waiting", {"b.bag", "lot", std::nullopt});
  ClaimJob(store_);

  const CareReport copied = BackUpData(data_, backup_);
  EXPECT_TRUE(copied.damaged.empty());
  EXPECT_EQ(copied.files, 5);  // two logs, two files of a map, a rig
  EXPECT_TRUE(VerifyData(backup_, /*deep=*/true).damaged.empty());
  EXPECT_TRUE(RestoreData(backup_, restored_).damaged.empty());

  Store restored(restored_);
  ReconcileFiles(restored);
  EXPECT_TRUE(fs::is_empty(restored_ / "quarantine"));
  const Drive found =
      restored.database.Read([&](Connection& connection) { return FindDrive(connection, drive); });
  EXPECT_EQ(ReadFile(restored.directory.LogFile(found.sha256)), "log one");
  const MapVersion map =
      restored.database.Read([&](Connection& connection) { return FindMap(connection, "lot", 1); });
  EXPECT_EQ(ReadFile(restored.directory.MapFolder(map.id) / "map.glb"), "glTF of log one");
  EXPECT_EQ(ReadFile(restored.directory.AttemptFolder(map.job, 1) / "log.txt"), "worked");
  EXPECT_TRUE(ClaimJob(restored).has_value()) << "what was running waits again";
}

TEST_F(Backup, CopiesOnlyWhatIsNew) {
  MapOne("log one");
  EXPECT_GT(BackUpData(data_, backup_).bytes, 0);
  EXPECT_EQ(BackUpData(data_, backup_).bytes, 0);
  MapOne("log two");
  EXPECT_EQ(BackUpData(data_, backup_).bytes, std::ssize(std::string("log two"
                                                                     "glTF of log two"
                                                                     "{}"
                                                                     "worked")));
}

TEST_F(Backup, NamesWhatIsDamagedAndCopiesTheRest) {
  MapOne("log one");
  MapOne("log two");
  AddRig();
  const std::string log = DataDirectory::LogPath(Sha256Of("log one"));
  Rot(data_ / log);
  const fs::path map = fs::directory_iterator(data_ / "maps")->path();
  fs::remove(map / "map.glb");

  EXPECT_EQ(VerifyData(data_, /*deep=*/false).damaged.size(), 1u) << "by their sizes";
  const CareReport found = VerifyData(data_, /*deep=*/true);
  ASSERT_EQ(found.damaged.size(), 2u);
  EXPECT_EQ(found.damaged[0].path, log);
  EXPECT_EQ(found.damaged[1].damage, "is missing");

  EXPECT_EQ(BackUpData(data_, backup_).damaged.size(), 2u);
  EXPECT_FALSE(fs::exists(backup_ / log)) << "what is damaged is not taken for whole";
  EXPECT_EQ(VerifyData(backup_, /*deep=*/true).damaged.size(), 2u);
}

TEST_F(Backup, RefusesWhatIsNotThereOrAlreadyThere) {
  EXPECT_THROW(VerifyData(root_.path() / "nothing", false), Error);
  EXPECT_THROW(RestoreData(root_.path() / "nothing", restored_), Error);
  BackUpData(data_, backup_);
  EXPECT_THROW(RestoreData(backup_, data_), Error);
}

// Drives come and go while it is made.
TEST_F(Backup, UnderLoadIsTheStateOfOneMoment) {
  std::atomic<bool> is_over = false;
  std::thread load([&] {
    for (int i = 0; i < 60 && !is_over; ++i) {
      const std::string drive = MapOne("log " + std::to_string(i) + std::string(100'000, 'x'));
      if (i % 2 == 0) DeleteDrive(store_, drive);
    }
  });
  for (int i = 0; i < 3; ++i) {
    const CareReport copied = BackUpData(data_, backup_);
    EXPECT_TRUE(copied.damaged.empty()) << copied.damaged[0].path << copied.damaged[0].damage;
    const CareReport found = VerifyData(backup_, /*deep=*/true);
    EXPECT_TRUE(found.damaged.empty()) << found.damaged[0].path << found.damaged[0].damage;
  }
  is_over = true;
  load.join();
}

}  // namespace
}  // namespace parkade
