#include <gtest/gtest.h>

#include <fstream>
#include <map>

#include "core/error.h"
#include "server/ingest/containers/open_log_source.h"
#include "tests/server/ingest/containers/sample_log.h"
#include "tests/support/archive_writer.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

// What a recorder leaves that was killed while SQLite wrote ahead: rows in drive.db3-wal.
class Rosbag2Wal : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    fs::create_directories(log_);
    fs::create_directories(scratch_);
    const auto made = RunScript("write_rosbag2.py", {file_.string(), GetParam()});
    if (!made) GTEST_SKIP() << "needs python3";
    std::ofstream(log_ / "drive.db3-shm") << "what the recorder shared";
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::map<std::string, std::vector<std::uint8_t>> Content() const {
    std::map<std::string, std::vector<std::uint8_t>> files;
    for (const auto& entry : fs::directory_iterator(log_))
      files[entry.path().filename()] = ReadBytes(entry.path());
    return files;
  }
  std::string ErrorOf(const fs::path& log) const {
    try {
      OpenLogSource(log, scratch_);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kInvalidInput);
      return error.what();
    }
    return "";
  }

  const fs::path folder_ = ScratchFile("-wal").path();
  const fs::path log_ = folder_ / "recording", scratch_ = folder_ / "scratch",
                 file_ = log_ / "drive.db3", wal_ = log_ / "drive.db3-wal";
};

INSTANTIATE_TEST_SUITE_P(Rows, Rosbag2Wal, testing::Values("wal=all", "wal=half"),
                         [](const auto& info) { return std::string(info.param).substr(4); });

TEST_P(Rosbag2Wal, IsReadWithTheDatabaseAndNothingIsWrittenBesideIt) {
  const auto before = Content();
  ASSERT_EQ(before.size(), 3u);

  for (const fs::path& log : {file_, log_}) {
    {
      const auto source = OpenLogSource(log, scratch_);
      const ReadLog read = ReadWhole(*source);
      EXPECT_EQ(read.found, AllSamples());
      EXPECT_EQ(read.num_misplaced, 0u);
      EXPECT_TRUE(read.damage.IsClean());
    }
    EXPECT_TRUE(fs::is_empty(scratch_)) << "the copy is gone with the source";
  }

  EXPECT_EQ(Content(), before);
}

TEST_P(Rosbag2Wal, IsReadByAPassThatOutlivesTheSource) {
  auto source = OpenLogSource(file_, scratch_);
  const auto stream = source->Read({true, true, true, true});
  source.reset();

  std::size_t count = 0;
  while (stream->Next()) ++count;

  EXPECT_EQ(count, 710u);
}

TEST_P(Rosbag2Wal, MayLieInAnArchive) {
  std::vector<Entry> entries = EntriesOf(log_, "recording/");
  std::reverse(entries.begin(), entries.end());  // the -wal first
  entries.push_back({"__MACOSX/recording/._drive.db3", "what macOS puts beside a file"});
  for (const char* kind : {"zip", "tar", "tar.gz", "tar.zst"}) {
    const fs::path archive = folder_ / (std::string("drive.") + kind);
    WriteArchive(archive, kind, entries);

    const ReadLog read = ReadWhole(*OpenLogSource(archive, scratch_));

    EXPECT_EQ(read.found, AllSamples()) << kind;
    EXPECT_TRUE(read.damage.IsClean()) << kind;
    EXPECT_TRUE(fs::is_empty(scratch_)) << kind;
  }
}

TEST_P(Rosbag2Wal, WithoutItTheRestIsReadOrASentenceSaysWhatIsMissing) {
  fs::remove(wal_);

  if (GetParam() == std::string("wal=half")) {
    EXPECT_EQ(ReadWhole(file_).found.size(), 355u);
  } else {
    EXPECT_EQ(
        ErrorOf(file_),
        "'drive.db3' holds no tables of rosbag2: they may be in 'drive.db3-wal', which belongs "
        "beside it");
  }
}

TEST_P(Rosbag2Wal, ThatIsNoneIsSaid) {
  std::ofstream(wal_) << std::string(100'000, 'x');

  if (GetParam() == std::string("wal=half")) {
    const ReadLog read = ReadWhole(file_);
    EXPECT_EQ(read.found.size(), 355u);
    ASSERT_EQ(read.damage.ranges.size(), 1u);
    EXPECT_EQ(read.damage.ranges[0].what,
              "'drive.db3-wal' beside it holds nothing that can be used");
  } else {
    EXPECT_EQ(ErrorOf(file_),
              "'drive.db3' holds no tables of rosbag2, and 'drive.db3-wal' beside it holds nothing "
              "that can be used");
  }
}

TEST_P(Rosbag2Wal, ThatIsCutGivesWhatWasCommitted) {
  fs::resize_file(wal_, fs::file_size(wal_) * 2 / 3);

  const std::size_t num_committed = GetParam() == std::string("wal=half") ? 355 : 0;
  EXPECT_EQ(ReadWhole(file_).found.size(), num_committed);
}

}  // namespace
}  // namespace parkade
