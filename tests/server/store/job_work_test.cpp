#include "server/store/job_work.h"

#include "server/store/care/retention.h"
#include "server/store/job_queue.h"
#include "server/store/review/site_settings.h"
#include "tests/server/store/temporary_store.h"

namespace parkade {
namespace {

using Days = std::chrono::days;

class JobWork : public StoreTest {
 protected:
  JobWork() {
    ClaimJob(store_);
    WriteText(Work() / "a" / "odometry.bin", "what was found");
  }
  std::filesystem::path Work() const { return store_.directory.WorkFolder(received_.job.id); }
  bool IsThere() const { return std::filesystem::exists(Work()); }
  void Fail() { FailJob(store_, JobNow(), "internal", "it failed"); }
  Job JobNow() {
    return store_.database.Read(
        [&](Connection& connection) { return FindJob(connection, received_.job.id); });
  }
  void DropIn(int days) { DropStaleWork(store_, std::chrono::system_clock::now() + Days(days)); }

  ReceivedDrive received_ = Receive(store_, "a log", {"a.bag", "lot", std::nullopt});
};

TEST_F(JobWork, StaysWithAJobThatMayBeTriedAgain) {
  DropIn(100);
  EXPECT_TRUE(IsThere()) << "it runs";
  Fail();
  ReconcileFiles(store_);
  DropIn(6);
  EXPECT_TRUE(IsThere());
  DropIn(8);
  EXPECT_FALSE(IsThere());
}

TEST_F(JobWork, GoesWithTheDriveThatItTellsOf) {
  Fail();
  DeleteDrive(store_, received_.drive.id);
  EXPECT_FALSE(IsThere());
}

TEST_F(JobWork, GoesWithTheLogWhoseTimeIsOver) {
  Fail();
  ChangeSite(store_, "lot", {.log_days = {3}});
  DeleteExpired(store_, std::chrono::system_clock::now() + Days(2));
  EXPECT_TRUE(IsThere());
  DeleteExpired(store_, std::chrono::system_clock::now() + Days(4));
  EXPECT_FALSE(IsThere());
}

}  // namespace
}  // namespace parkade
