#include <atomic>
#include <thread>

#include "server/store/access/tokens.h"
#include "tests/server/store/uploads/sets_of_uploads.h"

namespace parkade {
namespace {

using namespace std::chrono_literals;

TEST_F(SetsOfUploads, BecomeOneLogAndOneDriveInWhateverOrderTheirPartsCome) {
  const std::string a = "log a", b(3'000'000, 'b');
  const auto [set, parts] = DeclareTwo(b, a);
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_EQ(parts[0].path, "tour/a.bag") << "in order of their paths";
  EXPECT_EQ(parts[0].site, "lot");

  Append(parts[1].id, 0, b.substr(0, 1'000'001));
  EXPECT_EQ(Append(parts[0].id, 0, a).state, UploadState::kDone);
  EXPECT_EQ(sets().Look(set.id).set.state, UploadSetState::kReceiving);
  EXPECT_EQ(NumDrives(), 0u);
  Append(parts[1].id, 1'000'001, b.substr(1'000'001));

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
    Append(parts[1].id, 0, "log bb");
    Append(parts[0].id, 0, "log a");
    ASSERT_EQ(WaitForEnd(set.id).state, UploadSetState::kDone);
  }

  EXPECT_EQ(NumDrives(), 2u);
  EXPECT_EQ(NumLogs(), 1u);
}

TEST_F(SetsOfUploads, OfOnePartBecomeJustThatLog) {
  const auto [set, parts] = Declare({{"tour/a.zip", 5, std::nullopt}});
  Append(parts[0].id, 0, "log a");
  EXPECT_EQ(DriveOf(WaitForEnd(set.id)).sha256, Sha256Of("log a"));

  const auto [other, its_parts] = Declare({{"notes.txt", 5, std::nullopt}});
  Append(its_parts[0].id, 0, "notes");
  const UploadSet refused = WaitForEnd(other.id);
  EXPECT_EQ(refused.state, UploadSetState::kRefused);
  EXPECT_EQ(refused.error, "tour is no log");
  EXPECT_EQ(uploads_->Find(its_parts[0].id).state, UploadState::kRefused);
  EXPECT_TRUE(Soon([&] { return HasNoFile(); }));
}

TEST_F(SetsOfUploads, TakeADamagedPartAgainFromItsBeginning) {
  const auto [set, parts] = DeclareTwo("log b", "log a");
  Append(parts[0].id, 0, "log a");
  Append(parts[1].id, 0, "lo");

  EXPECT_THROW(Append(parts[1].id, 2, "g x"), ChecksumMismatch);

  EXPECT_EQ(uploads_->Find(parts[1].id).offset, 0);
  EXPECT_EQ(uploads_->Find(parts[1].id).state, UploadState::kReceiving);
  EXPECT_EQ(uploads_->Find(parts[0].id).state, UploadState::kDone) << "the others stay";
  EXPECT_EQ(NumDrives(), 0u);
  Append(parts[1].id, 0, "log b");
  EXPECT_EQ(WaitForEnd(set.id).state, UploadSetState::kDone);
}

// What a kill leaves between the steps, from the last byte to the drive.
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
  for (const size_t i : {0u, 1u, 5'000u, 9'999u}) Append(parts[i].id, 0, "log ");
  const auto files = FilesOfTar(store_.directory.UploadFile(set.id));
  EXPECT_EQ(files.size(), 10'000u);
  EXPECT_EQ(files.at(*parts[5'000].path), "log ");
  EXPECT_EQ(files.at(*parts[5'001].path), std::string(4, '\0'));
}

TEST_F(SetsOfUploads, AreTerminatedWithAllTheirParts) {
  const auto [set, parts] = DeclareTwo("log b", "log a");
  Append(parts[0].id, 0, "log a");
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
    Append(parts[0].id, 0, "log a");
    Append(parts[1].id, 0, "log b");
  }

  const Drive drive = DriveOf(WaitForEnd(id));

  EXPECT_EQ(drive.created_by, caller.id);
}

}  // namespace
}  // namespace parkade
