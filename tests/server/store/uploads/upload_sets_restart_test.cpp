// What restarts, kills, lost files and time do to sets of uploads.

#include <fstream>
#include <thread>

#include "server/store/care/backup.h"
#include "server/store/disk/durable_file.h"
#include "tests/server/store/uploads/sets_of_uploads.h"

namespace parkade {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

TEST_F(SetsOfUploads, GoOnAfterRestartsBetweenAnyTwoParts) {
  const auto [set, parts] = DeclareTwo("log b", "log a");
  Append(parts[1].id, 0, "lo");
  Open();
  Append(parts[0].id, 0, "log a");
  ReconcileFiles(store_);  // as a service does when it starts
  Open();
  EXPECT_EQ(uploads_->Find(parts[1].id).offset, 2);
  Append(parts[1].id, 2, "g b");

  const UploadSet done = WaitForEnd(set.id);

  EXPECT_EQ(LogOf(done).at("tour/b.bag"), "log b");
  EXPECT_EQ(NumDrives(), 1u);
}

TEST_F(SetsOfUploads, WhosePartsAreThereAreFinishedByTheNextService) {
  for (const char* kill : {"last byte durable", "last part whole", "assembling", "read-only"}) {
    const auto [set, parts] = DeclareTwo("log b", "log a");
    Append(parts[0].id, 0, "log a");
    uploads_.reset();
    const fs::path file = store_.directory.UploadFile(set.id);
    std::fstream(file, std::ios::in | std::ios::out | std::ios::binary).seekp(parts[1].first_byte)
        << "log b";
    store_.database.Write([&, &set = set, &parts = parts](Connection& connection) {
      SetUploadOffset(connection, parts[1].id, 5, "3000-01-01");
      if (kill != std::string("last byte durable")) SetUploadWhole(connection, parts[1].id);
      if (kill == std::string("assembling")) SetUploadSetAssembling(connection, set.id);
    });
    if (kill == std::string("read-only")) MakeReadOnly(file);
    ReconcileFiles(store_);

    Open();

    const UploadSet done = WaitForEnd(set.id);
    ASSERT_EQ(done.state, UploadSetState::kDone) << kill;
    EXPECT_EQ(LogOf(done).at("tour/b.bag"), "log b") << kill;
  }
  EXPECT_EQ(NumDrives(), 4u) << "one each, nothing twice";
  EXPECT_EQ(NumLogs(), 1u);
}

TEST_F(SetsOfUploads, ThatAreDoneLeaveNothingToAKillAfterwards) {
  const auto [set, parts] = DeclareTwo("log b", "log a");
  Append(parts[0].id, 0, "log a");
  Append(parts[1].id, 0, "log b");
  ASSERT_EQ(WaitForEnd(set.id).state, UploadSetState::kDone);
  uploads_.reset();
  WriteText(store_.directory.UploadFile(set.id), "what a kill before the removal leaves");

  ReconcileFiles(store_);
  Open();

  EXPECT_TRUE(HasNoFile());
  EXPECT_EQ(store_.directory.quarantine().num_entries(), 0);
  EXPECT_EQ(NumDrives(), 1u);
}

TEST_F(SetsOfUploads, WhoseFileTheDiskLostAreRefused) {
  const auto [set, parts] = DeclareTwo("log b", "log a");
  Append(parts[0].id, 0, "log a");
  uploads_.reset();
  fs::resize_file(store_.directory.UploadFile(set.id), 100);

  Open();

  EXPECT_EQ(WaitForEnd(set.id).error_code, "internal");
  EXPECT_THROW(Append(parts[1].id, 0, "log b"), Error);
}

TEST_F(SetsOfUploads, ExpireAsAWhole) {
  Open(-1h);
  const auto [expired, expired_parts] = DeclareTwo("log b", "log a");
  Append(expired_parts[0].id, 0, "log a");
  Open(24h);  // tidies up at its start
  EXPECT_TRUE(Soon([&] { return HasNoFile(); }));
  EXPECT_THROW(sets().Look(expired.id), Error);
  EXPECT_THROW(uploads_->Look(expired_parts[0].id), Error);

  const auto [alive, parts] = DeclareTwo("log b", "log a");
  store_.database.Write([&, &parts = parts](Connection& connection) {
    connection.Execute("UPDATE uploads SET expires_at = '2000-01-01' WHERE upload_set IS NOT NULL");
    SetUploadOffset(connection, parts[0].id, 0, "3000-01-01");
  });
  Open(24h);
  std::this_thread::sleep_for(100ms);
  EXPECT_EQ(uploads_->Find(parts[1].id).expires_at, "3000-01-01") << "a part lives with its set";
}

TEST_F(SetsOfUploads, ThatAreNotDoneAreLeftOutOfBackups) {
  const auto [set, parts] = DeclareTwo("log b", "log a");
  Append(parts[0].id, 0, "log a");
  const auto [done, its_parts] = DeclareTwo("log b", "log a");
  Append(its_parts[0].id, 0, "log a");
  Append(its_parts[1].id, 0, "log b");
  ASSERT_EQ(WaitForEnd(done.id).state, UploadSetState::kDone);

  const fs::path backup = root_.path() / "backup";
  EXPECT_TRUE(BackUpData(store_.directory.root(), backup).damaged.empty());

  EXPECT_TRUE(VerifyData(backup, true).damaged.empty());
  Database copy(backup / "db" / "main.db", DatabaseUse::kLook);
  copy.Read([&, &set = set, &done = done](Connection& connection) {
    EXPECT_THROW(FindUploadSet(connection, set.id), Error);
    EXPECT_TRUE(UploadsOfSet(connection, set.id).empty());
    EXPECT_EQ(FindUploadSet(connection, done.id).state, UploadSetState::kDone);
    EXPECT_EQ(UploadsOfSet(connection, done.id).size(), 2u);
  });
}

}  // namespace
}  // namespace parkade
