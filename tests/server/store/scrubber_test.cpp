#include "server/store/care/scrubber.h"

#include <thread>
#include <utility>

#include "server/store/job_queue.h"
#include "server/store/rig_store.h"
#include "server/store/tables/check_table.h"
#include "tests/server/store/temporary_store.h"

namespace parkade {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

class Scrub : public StoreTest {
 protected:
  /// Logs of a few bytes to a few MiB.
  void ReceiveLogs(int count) {
    for (int i = 0; i < count; ++i) {
      const std::string content =
          "log " + std::to_string(i) +
          std::string(static_cast<size_t>(i % 10 == 0 ? 2'000'000 : 50), 'x');
      files_.push_back(store_.directory.LogFile(
          Receive(store_, content, {"a.bag", "lot", std::nullopt}).drive.sha256));
    }
  }
  static void Rot(const fs::path& file, std::int64_t at) {
    fs::permissions(file, fs::perms::owner_write, fs::perm_options::add);
    std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
    stream.seekp(at);
    stream.put('\x02');
  }
  std::int64_t Damaged() { return store_.database.Read(CountDamagedFiles); }
  /// Waits as long as more are found: each takes a sync, which busy disks are slow with.
  bool Eventually(std::int64_t damaged) {
    std::int64_t last = -1, now = Damaged();
    for (int i = 0; i < 3000 && now != damaged; i = now == last ? i + 1 : 0) {
      std::this_thread::sleep_for(20ms);
      last = std::exchange(now, Damaged());
    }
    return now == damaged;
  }

  std::vector<fs::path> files_;
};

TEST_F(Scrub, FindsEveryByteThatRotted) {
  ReceiveLogs(100);
  for (const fs::path& file : files_)
    Rot(file, static_cast<std::int64_t>(fs::file_size(file)) * 2 / 3);
  const Scrubber scrubber(store_, 1ms);

  EXPECT_TRUE(Eventually(100)) << Damaged();
}

TEST_F(Scrub, ReadsNothingBeforeItIsDue) {
  ReceiveLogs(2);
  Rot(files_[0], 3);
  fs::remove(files_[1]);
  {
    const Scrubber scrubber(store_, 24h);
    EXPECT_TRUE(Eventually(1)) << "what is gone is seen without reading";
    std::this_thread::sleep_for(100ms);
  }
  EXPECT_EQ(Damaged(), 1);
}

TEST_F(Scrub, ForgetsFilesThatWereDeleted) {
  const ReceivedDrive drive = Receive(store_, "log", {"a.bag", "lot", std::nullopt});
  CancelWaitingJob(store_, drive.job.id);
  RecordFileCheck(store_, DataDirectory::LogPath(drive.drive.sha256), "is missing");
  ASSERT_EQ(Damaged(), 1);

  DeleteDrive(store_, drive.drive.id);

  EXPECT_EQ(Damaged(), 0);
}

TEST_F(Scrub, ChecksRigsAsTheyAreHandedOut) {
  const StoredRig rig =
      StoreRig(store_, "car",
               {{"camchain-imucam.yaml", "a"}, {"imu0.yaml", "b"}, {"vehicle.yaml", "c"}}, nullptr);
  const Scrubber scrubber(store_, 1ms);
  std::this_thread::sleep_for(50ms);
  EXPECT_EQ(Damaged(), 0);

  WriteText(store_.directory.RigFolder(rig.id) / "imu0.yaml", "d");

  EXPECT_TRUE(Eventually(1));
}

}  // namespace
}  // namespace parkade
