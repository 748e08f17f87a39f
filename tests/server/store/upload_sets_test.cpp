#include "server/store/uploads/upload_sets.h"

#include <archive.h>
#include <archive_entry.h>

#include <atomic>
#include <map>
#include <thread>

#include "core/file.h"
#include "server/store/access/tokens.h"
#include "server/store/care/backup.h"
#include "server/store/disk/durable_file.h"
#include "server/store/job_queue.h"
#include "server/store/tables/drive_table.h"
#include "server/store/uploads/resumable_uploads.h"
#include "tests/server/store/temporary_store.h"

namespace parkade {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

/// The files of a tar, by their paths.
std::map<std::string, std::string> FilesOfTar(const fs::path& file) {
  archive* reader = archive_read_new();
  archive_read_support_format_tar(reader);
  EXPECT_EQ(archive_read_open_filename(reader, file.c_str(), 10240), ARCHIVE_OK);
  std::map<std::string, std::string> files;
  archive_entry* entry = nullptr;
  int status;
  while ((status = archive_read_next_header(reader, &entry)) == ARCHIVE_OK) {
    std::string content(static_cast<size_t>(archive_entry_size(entry)), '\0');
    EXPECT_EQ(archive_read_data(reader, content.data(), content.size()), std::ssize(content));
    EXPECT_EQ(archive_entry_mtime(entry), 0);
    files[archive_entry_pathname(entry)] = content;
  }
  EXPECT_EQ(status, ARCHIVE_EOF) << archive_error_string(reader);
  archive_read_free(reader);
  return files;
}

class SetsOfUploads : public StoreTest {
 protected:
  void SetUp() override { Open(); }

  void Open(std::chrono::hours lifetime = 24h) {
    uploads_.reset();
    UploadOptions options;
    options.check_log = [](const fs::path& file, const std::string& name) {
      Require(ReadFile(file).starts_with("log"), ErrorCode::kInvalidInput, name + " is no log");
    };
    options.check_paths = [](const std::vector<std::string>& paths) {
      for (const std::string& path : paths)
        Require(path.ends_with(".bag"), ErrorCode::kInvalidInput, path + " is no bag");
    };
    options.on_received = [this](const ReceivedDrive&) { ++received_; };
    options.lifetime = lifetime;
    uploads_.emplace(store_, options);
  }
  UploadSets& sets() { return uploads_->sets(); }

  UploadSets::SetWithParts Declare(std::vector<UploadPart> parts) {
    UploadSet set;
    set.filename = "tour";
    set.site = "lot";
    return sets().Create(set, std::move(parts));
  }
  /// A set of "b.bag" and "a.bag", with these contents.
  UploadSets::SetWithParts DeclareTwo(const std::string& b, const std::string& a) {
    return Declare(
        {{"tour/b.bag", std::ssize(b), Sha256Of(b)}, {"tour/a.bag", std::ssize(a), std::nullopt}});
  }
  Upload Append(const Upload& part, std::int64_t offset, const std::string& text) {
    return uploads_->Append(
        part.id, offset, std::ssize(text),
        [&](const auto& take) {
          take(text);
          return true;
        },
        std::nullopt, [] {});
  }
  UploadSet WaitForEnd(const std::string& id) {
    UploadSet set;
    for (int i = 0; i < 1000; ++i, std::this_thread::sleep_for(10ms)) {
      set = sets().Look(id).set;
      if (set.state == UploadSetState::kDone || set.state == UploadSetState::kRefused) break;
    }
    return set;
  }
  /// What is done after the row of a set says that it has ended.
  template <typename Probe>
  static bool Soon(const Probe& probe) {
    for (int i = 0; i < 1000 && !probe(); ++i) std::this_thread::sleep_for(10ms);
    return probe();
  }
  bool HasNoFile() const { return fs::is_empty(store_.directory.UploadsFolder()); }
  Drive DriveOf(const UploadSet& set) {
    return store_.database.Read(
        [&](Connection& connection) { return FindDrive(connection, set.drive.value_or("")); });
  }
  std::map<std::string, std::string> LogOf(const UploadSet& set) {
    return FilesOfTar(store_.directory.LogFile(DriveOf(set).sha256));
  }
  size_t NumDrives() {
    return store_.database
        .Read([](Connection& connection) { return ListDrives(connection, {}, std::nullopt); })
        .size();
  }
  size_t NumLogs() {
    size_t count = 0;
    for (const std::string& name : ContentOf(store_.directory.LogsFolder()))
      count += name.ends_with('/') ? 0 : 1;
    return count;
  }

  std::optional<ResumableUploads> uploads_;
  std::atomic<int> received_ = 0;
};

TEST_F(SetsOfUploads, BecomeOneLogAndOneDriveInWhateverOrderTheirPartsCome) {
  const std::string a = "log a", b(3'000'000, 'b');
  const auto [set, parts] = DeclareTwo(b, a);
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_EQ(parts[0].path, "tour/a.bag") << "in order of their paths";
  EXPECT_EQ(parts[0].site, "lot");

  Append(parts[1], 0, b.substr(0, 1'000'001));
  EXPECT_EQ(Append(parts[0], 0, a).state, UploadState::kDone);
  EXPECT_EQ(sets().Look(set.id).set.state, UploadSetState::kReceiving);
  EXPECT_EQ(NumDrives(), 0u);
  Append(parts[1], 1'000'001, b.substr(1'000'001));

  const UploadSet done = WaitForEnd(set.id);
  ASSERT_EQ(done.state, UploadSetState::kDone) << done.error.value_or("");
  EXPECT_EQ(LogOf(done),
            (std::map<std::string, std::string>{{"tour/a.bag", a}, {"tour/b.bag", b}}));
  const Drive drive = DriveOf(done);
  EXPECT_EQ(drive.filename, "tour");
  EXPECT_EQ(drive.site, "lot");
  EXPECT_EQ(drive.sha256, Sha256OfFile(store_.directory.LogFile(drive.sha256)));
  EXPECT_EQ(uploads_->Find(parts[0].id).drive, done.drive);
  EXPECT_TRUE(Soon([&] { return received_ == 1 && HasNoFile(); }));
}

TEST_F(SetsOfUploads, OfEqualContentAreStoredOnce) {
  for (const bool is_turned : {false, true}) {
    std::vector<UploadPart> declared = {{"a.bag", 5, std::nullopt}, {"b.bag", 6, std::nullopt}};
    if (is_turned) std::swap(declared[0], declared[1]);
    const auto [set, parts] = Declare(declared);
    Append(parts[1], 0, "log bb");
    Append(parts[0], 0, "log a");
    ASSERT_EQ(WaitForEnd(set.id).state, UploadSetState::kDone);
  }

  EXPECT_EQ(NumDrives(), 2u);
  EXPECT_EQ(NumLogs(), 1u);
}

TEST_F(SetsOfUploads, OfOnePartBecomeJustThatLog) {
  const auto [set, parts] = Declare({{"tour/a.zip", 5, std::nullopt}});
  Append(parts[0], 0, "log a");
  EXPECT_EQ(DriveOf(WaitForEnd(set.id)).sha256, Sha256Of("log a"));

  const auto [other, its_parts] = Declare({{"notes.txt", 5, std::nullopt}});
  Append(its_parts[0], 0, "notes");
  const UploadSet refused = WaitForEnd(other.id);
  EXPECT_EQ(refused.state, UploadSetState::kRefused);
  EXPECT_EQ(refused.error, "tour is no log");
  EXPECT_EQ(uploads_->Find(its_parts[0].id).state, UploadState::kRefused);
  EXPECT_TRUE(Soon([&] { return HasNoFile(); }));
}

TEST_F(SetsOfUploads, TakeADamagedPartAgainFromItsBeginning) {
  const auto [set, parts] = DeclareTwo("log b", "log a");
  Append(parts[0], 0, "log a");
  Append(parts[1], 0, "lo");

  EXPECT_THROW(Append(parts[1], 2, "g x"), ChecksumMismatch);

  EXPECT_EQ(uploads_->Find(parts[1].id).offset, 0);
  EXPECT_EQ(uploads_->Find(parts[1].id).state, UploadState::kReceiving);
  EXPECT_EQ(uploads_->Find(parts[0].id).state, UploadState::kDone) << "the others stay";
  EXPECT_EQ(NumDrives(), 0u);
  Append(parts[1], 0, "log b");
  EXPECT_EQ(WaitForEnd(set.id).state, UploadSetState::kDone);
}

TEST_F(SetsOfUploads, GoOnAfterRestartsBetweenAnyTwoParts) {
  const auto [set, parts] = DeclareTwo("log b", "log a");
  Append(parts[1], 0, "lo");
  Open();
  Append(parts[0], 0, "log a");
  ReconcileFiles(store_);  // as a service does when it starts
  Open();
  EXPECT_EQ(uploads_->Find(parts[1].id).offset, 2);
  Append(parts[1], 2, "g b");

  const UploadSet done = WaitForEnd(set.id);

  EXPECT_EQ(LogOf(done).at("tour/b.bag"), "log b");
  EXPECT_EQ(NumDrives(), 1u);
}

// What a kill leaves between the steps, from the last byte to the drive.
TEST_F(SetsOfUploads, WhosePartsAreThereAreFinishedByTheNextService) {
  for (const char* kill : {"last byte durable", "last part whole", "assembling", "read-only"}) {
    const auto [set, parts] = DeclareTwo("log b", "log a");
    Append(parts[0], 0, "log a");
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
  Append(parts[0], 0, "log a");
  Append(parts[1], 0, "log b");
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
  Append(parts[0], 0, "log a");
  uploads_.reset();
  fs::resize_file(store_.directory.UploadFile(set.id), 100);

  Open();

  EXPECT_EQ(WaitForEnd(set.id).error_code, "internal");
  EXPECT_THROW(Append(parts[1], 0, "log b"), Error);
}

TEST_F(SetsOfUploads, ReserveTheRoomOfAllPartsBeforehand) {
  const auto code_of = [&](std::vector<UploadPart> parts) -> std::optional<ErrorCode> {
    try {
      Declare(std::move(parts));
    } catch (const Error& error) {
      return error.code();
    }
    return std::nullopt;
  };
  const std::int64_t free = FreeBytes(store_.directory.root());
  EXPECT_EQ(code_of({{"a.bag", free / 2, {}}, {"b.bag", free / 2 + 1, {}}}), ErrorCode::kDiskFull);
  EXPECT_EQ(code_of({{"a.bag", INT64_MAX, {}}, {"b.bag", INT64_MAX, {}}}), ErrorCode::kDiskFull);
  EXPECT_TRUE(HasNoFile());
  EXPECT_TRUE(store_.database.Read(UnfinishedUploads).empty());
}

TEST_F(SetsOfUploads, OfUnusablePartsAreRefusedBeforeAByte) {
  const auto is_refused = [&](std::vector<UploadPart> parts) {
    try {
      Declare(std::move(parts));
    } catch (const Error& error) {
      return error.code() == ErrorCode::kInvalidInput;
    }
    return false;
  };
  EXPECT_TRUE(is_refused({}));
  for (const std::string path : {"", "/a.bag", "../a.bag", "a/../b.bag", "./a.bag", "a//b.bag",
                                 "a.bag/", "a\\b.bag", "a\nb.bag", "\xc3\xa4.bag"})
    EXPECT_TRUE(is_refused({{path, 5, {}}})) << path;
  EXPECT_TRUE(is_refused({{std::string(252, 'a') + ".bag", 5, {}}}));
  EXPECT_TRUE(is_refused({{"a.bag", 5, {}}, {"a.bag", 6, {}}}));
  EXPECT_TRUE(is_refused({{"a.bag", 0, {}}}));
  EXPECT_TRUE(is_refused({{"a.bag", -5, {}}}));
  EXPECT_TRUE(is_refused({{"a.bag", 5, "ABC"}}));
  EXPECT_TRUE(is_refused({{"a.bag", 5, {}}, {"a.txt", 5, {}}})) << "no archive of a drive";
  EXPECT_TRUE(is_refused(std::vector<UploadPart>(10'001, {"a.bag", 5, {}})));
  EXPECT_TRUE(HasNoFile());
}

TEST_F(SetsOfUploads, MayHaveThousandsOfPartsAndLongPaths) {
  std::vector<UploadPart> declared;
  for (int i = 0; i < 10'000; ++i)
    declared.push_back({std::string(230, 'd') + "/" + std::to_string(i) + ".bag", 4, {}});

  const auto [set, parts] = Declare(declared);

  ASSERT_EQ(parts.size(), 10'000u);
  for (const size_t i : {0u, 1u, 5'000u, 9'999u}) Append(parts[i], 0, "log ");
  const auto files = FilesOfTar(store_.directory.UploadFile(set.id));
  EXPECT_EQ(files.size(), 10'000u);
  EXPECT_EQ(files.at(*parts[5'000].path), "log ");
  EXPECT_EQ(files.at(*parts[5'001].path), std::string(4, '\0'));
}

TEST_F(SetsOfUploads, AreTerminatedWithAllTheirParts) {
  const auto [set, parts] = DeclareTwo("log b", "log a");
  Append(parts[0], 0, "log a");
  EXPECT_THROW(uploads_->Terminate(parts[1].id), Error) << "a part does not go alone";

  sets().Terminate(set.id);

  EXPECT_THROW(sets().Look(set.id), Error);
  for (const Upload& part : parts) EXPECT_THROW(uploads_->Look(part.id), Error);
  EXPECT_TRUE(HasNoFile());
}

TEST_F(SetsOfUploads, AreTakenFromWhoeverStillAddsToThem) {
  const auto [set, parts] = DeclareTwo("log b", "log a");
  std::atomic<bool> has_begun = false, is_given_up = false;
  std::thread stuck([&, &parts = parts] {
    const auto part = [&](const auto& take) {
      take("log");
      has_begun = true;
      while (!is_given_up) std::this_thread::sleep_for(1ms);
      return false;
    };
    EXPECT_THROW(
        uploads_->Append(parts[0].id, 0, 5, part, std::nullopt, [&] { is_given_up = true; }),
        Error);
  });
  while (!has_begun) std::this_thread::sleep_for(1ms);

  sets().Terminate(set.id);

  stuck.join();
  EXPECT_TRUE(HasNoFile());
}

TEST_F(SetsOfUploads, ExpireAsAWhole) {
  Open(-1h);
  const auto [expired, expired_parts] = DeclareTwo("log b", "log a");
  Append(expired_parts[0], 0, "log a");
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

TEST_F(SetsOfUploads, BelongToWhoeverDeclaredThem) {
  Token token;
  token.name = "car 7";
  token.role = Role::kAdmin;
  const Caller caller = CallerOf(CreateToken(store_.database, token).token);
  std::string id;
  {
    const WorkFor scope(caller);
    const auto [set, parts] = DeclareTwo("log b", "log a");
    id = set.id;
    Append(parts[0], 0, "log a");
    Append(parts[1], 0, "log b");
  }

  const Drive drive = DriveOf(WaitForEnd(id));

  EXPECT_EQ(drive.created_by, caller.id);
}

TEST_F(SetsOfUploads, ThatAreNotDoneAreLeftOutOfBackups) {
  const auto [set, parts] = DeclareTwo("log b", "log a");
  Append(parts[0], 0, "log a");
  const auto [done, its_parts] = DeclareTwo("log b", "log a");
  Append(its_parts[0], 0, "log a");
  Append(its_parts[1], 0, "log b");
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
