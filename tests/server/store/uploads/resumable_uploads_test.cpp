#include <thread>

#include "server/store/job_queue.h"
#include "server/store/uploads/part_digest.h"
#include "tests/server/store/uploads/upload_test.h"

namespace parkade {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

class UploadInParts : public UploadTest {
 protected:
  std::string Create(std::int64_t length) {
    Upload upload;
    upload.filename = "a.bag";
    upload.site = "lot";
    upload.length = length;
    return uploads_->Create(upload).id;
  }
  /// A part whose sender goes away after `text`.
  void BreakOff(const std::string& id, std::int64_t offset, std::int64_t bytes,
                const std::string& text,
                const std::optional<PartChecksum>& checksum = std::nullopt) {
    const auto part = [&](const auto& take) {
      take(text);
      return false;
    };
    EXPECT_THROW(uploads_->Append(id, offset, bytes, part, checksum, [] {}), Error);
  }
  static std::string Digest(const std::string& algorithm, const std::string& text) {
    PartDigest digest(algorithm);
    digest.Add(text);
    return digest.Finish();
  }
};

TEST_F(UploadInParts, BecomeADriveWithTheirLastPart) {
  const std::string id = Create(10);
  EXPECT_EQ(Append(id, 0, "log ").offset, 4);
  EXPECT_EQ(Append(id, 4, "12").offset, 6);

  const Upload done = Append(id, 6, "3456");

  EXPECT_EQ(done.state, UploadState::kDone);
  ASSERT_TRUE(done.drive.has_value());
  const Drive drive = store_.database.Read(
      [&](Connection& connection) { return FindDrive(connection, *done.drive); });
  EXPECT_EQ(drive.sha256, Sha256Of("log 123456"));
  EXPECT_EQ(ReadFile(store_.directory.LogFile(drive.sha256)), "log 123456");
  EXPECT_TRUE(fs::is_empty(store_.directory.UploadsFolder()));
  EXPECT_EQ(received_, 1);
  EXPECT_EQ(Append(id, 10, "").drive, done.drive) << "asked again, the same answer";
}

TEST_F(UploadInParts, KeepWhatCameBeforeAPartBrokeOff) {
  const std::string id = Create(10);
  BreakOff(id, 0, 10, "log 12");
  EXPECT_EQ(uploads_->Find(id).offset, 6);

  EXPECT_THROW(Append(id, 4, "123456"), Error) << "another offset than the upload's";

  EXPECT_EQ(Append(id, 6, "3456").state, UploadState::kDone);
}

TEST_F(UploadInParts, GoOnAfterARestart) {
  const std::string id = Create(10);
  Append(id, 0, "log 1");
  WriteText(store_.directory.UploadFile(id), "log 1 and what was not durable");
  Open();

  EXPECT_EQ(uploads_->Find(id).offset, 5);
  const Upload done = Append(id, 5, "23456");

  ASSERT_EQ(done.state, UploadState::kDone);
  EXPECT_TRUE(fs::exists(store_.directory.LogFile(Sha256Of("log 123456"))));
}

TEST_F(UploadInParts, ThatCameWholeAreFinishedByTheNextService) {
  const std::string id = Create(5);
  WriteText(store_.directory.UploadFile(id), "log 1");
  store_.database.Write(
      [&](Connection& connection) { SetUploadOffset(connection, id, 5, "3000-01-01"); });

  Open();

  for (int i = 0; i < 500 && received_ == 0; ++i) std::this_thread::sleep_for(10ms);
  EXPECT_EQ(uploads_->Find(id).state, UploadState::kDone);
  EXPECT_EQ(NumDrives(), 1u);
}

TEST_F(UploadInParts, ThatCameWholeAreFinishedWhereThatFailedAtFirst) {
  const std::string id = Create(5);
  const fs::path away = root_.path() / "away";
  fs::rename(store_.directory.LogsFolder(), away);
  WriteText(store_.directory.LogsFolder(), "in the way");
  EXPECT_ANY_THROW(Append(id, 0, "log 1"));
  EXPECT_EQ(uploads_->Find(id).offset, 5);
  EXPECT_EQ(uploads_->Find(id).state, UploadState::kReceiving);
  fs::remove(store_.directory.LogsFolder());
  fs::rename(away, store_.directory.LogsFolder());

  EXPECT_EQ(Append(id, 5, "").state, UploadState::kDone);
  EXPECT_EQ(NumDrives(), 1u);
}

TEST_F(UploadInParts, WhoseBytesTheDiskLostAreRefused) {
  const std::string id = Create(10);
  Append(id, 0, "log 123");
  fs::resize_file(store_.directory.UploadFile(id), 3);

  Open();

  for (int i = 0; i < 500 && uploads_->Find(id).state == UploadState::kReceiving; ++i)
    std::this_thread::sleep_for(10ms);
  EXPECT_EQ(uploads_->Find(id).error_code, "internal");
  EXPECT_THROW(Append(id, 7, "456"), Error);
}

TEST_F(UploadInParts, TakePartsOnlyWithTheirChecksum) {
  const std::string id = Create(10);
  for (const std::string algorithm : {"sha1", "sha256"}) {
    const std::string bad = Digest(algorithm, "log 9");
    EXPECT_THROW(Append(id, 0, "log 1", PartChecksum{algorithm, bad}), ChecksumMismatch);
    EXPECT_EQ(uploads_->Find(id).offset, 0);
  }
  BreakOff(id, 0, 10, "log 1", PartChecksum{"sha1", Digest("sha1", "log 123456")});
  EXPECT_EQ(uploads_->Find(id).offset, 0) << "what cannot be checked is not kept";

  Append(id, 0, "log 1", PartChecksum{"sha1", Digest("sha1", "log 1")});
  const Upload done = Append(id, 5, "23456", PartChecksum{"sha256", Digest("sha256", "23456")});

  EXPECT_EQ(done.state, UploadState::kDone);
  EXPECT_TRUE(fs::exists(store_.directory.LogFile(Sha256Of("log 123456"))));
}

TEST_F(UploadInParts, AreRefusedWhenTheWholeIsNotWhatWasAnnounced) {
  Upload upload;
  upload.length = 5;
  upload.sha256 = Sha256Of("log 2");
  const std::string id = uploads_->Create(upload).id;

  EXPECT_THROW(Append(id, 0, "log 1"), Error);

  EXPECT_EQ(uploads_->Find(id).state, UploadState::kRefused);
  EXPECT_TRUE(fs::is_empty(store_.directory.UploadsFolder()));
  EXPECT_EQ(NumDrives(), 0u);
}

TEST_F(UploadInParts, ThatAreNoLogsAreRefusedForGood) {
  const std::string id = Create(4);
  EXPECT_THROW(Append(id, 0, "list"), Error);
  const Upload refused = uploads_->Find(id);
  EXPECT_EQ(refused.state, UploadState::kRefused);
  EXPECT_EQ(refused.error, "a.bag is no log");
  EXPECT_THROW(Append(id, 4, ""), Error);
}

TEST_F(UploadInParts, ReserveTheirRoomBeforehand) {
  EXPECT_THROW(Create(std::int64_t{1} << 60), Error);
  EXPECT_THROW(Create(0), Error);
  EXPECT_TRUE(fs::is_empty(store_.directory.UploadsFolder()));
  EXPECT_THROW(Append(Create(3), 0, "longer"), Error);
}

TEST_F(UploadInParts, PassToWhoeverAsksLast) {
  const std::string id = Create(10);
  std::atomic<bool> has_begun = false, is_given_up = false;
  std::thread stuck([&] {
    const auto part = [&](const auto& take) {
      take("log");
      has_begun = true;
      while (!is_given_up) std::this_thread::sleep_for(1ms);
      return false;
    };
    EXPECT_THROW(uploads_->Append(id, 0, 10, part, std::nullopt, [&] { is_given_up = true; }),
                 Error);
  });
  while (!has_begun) std::this_thread::sleep_for(1ms);
  const auto start = std::chrono::steady_clock::now();

  EXPECT_EQ(uploads_->Find(id).offset, 3);

  EXPECT_LT(std::chrono::steady_clock::now() - start, 8s) << "not by patience";
  stuck.join();
}

TEST_F(UploadInParts, ExpireAndAreTerminated) {
  const std::string terminated = Create(10), kept = Create(10);
  Append(terminated, 0, "log");
  uploads_->Terminate(terminated);
  EXPECT_THROW(uploads_->Find(terminated), Error);
  EXPECT_FALSE(fs::exists(store_.directory.UploadFile(terminated)));

  Open(-1h);
  const std::string expired = Create(10);
  Open();  // tidies up at its start

  for (int i = 0; i < 500 && fs::exists(store_.directory.UploadFile(expired)); ++i)
    std::this_thread::sleep_for(10ms);
  EXPECT_THROW(uploads_->Find(expired), Error);
  EXPECT_EQ(uploads_->Find(kept).offset, 0);
}

// Chunks of every size, kills in between: the log is what was sent.
TEST_F(UploadInParts, AddUpToWhatWasSent) {
  std::string log = "log ";
  for (int i = 0; i < 3'000'000; ++i)
    log += static_cast<char>(static_cast<unsigned>(i) * static_cast<unsigned>(i) >> 3);
  const std::string id = Create(std::ssize(log));
  std::int64_t offset = 0;
  for (int i = 1; offset < std::ssize(log); ++i) {
    const std::string part =
        log.substr(static_cast<size_t>(offset), static_cast<size_t>(i) * 40'001);
    if (i % 3 == 0) {
      BreakOff(id, offset, std::ssize(part), part.substr(0, part.size() / 2));
    } else {
      Append(id, offset, part);
    }
    if (i % 4 == 0) Open();
    offset = uploads_->Find(id).offset;
  }

  EXPECT_EQ(uploads_->Find(id).state, UploadState::kDone);
  EXPECT_EQ(ReadFile(store_.directory.LogFile(Sha256Of(log))), log);
}

}  // namespace
}  // namespace parkade
