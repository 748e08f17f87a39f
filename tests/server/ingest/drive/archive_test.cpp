#include <gtest/gtest.h>

#include "core/error.h"
#include "server/ingest/drive/open_drive_log.h"
#include "server/ingest/files/archive_extraction.h"
#include "tests/server/ingest/drive/euroc_folder.h"
#include "tests/support/archive_writer.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

std::string WhatExtractionThrows(const fs::path& archive, const fs::path& target) {
  try {
    ExtractArchive(archive, target);
  } catch (const Error& error) {
    return error.what();
  }
  return "nothing";
}

int CountRecords(const DriveLog& log) {
  int count = 0;
  const auto stream = log.Read({});
  while (stream->Next()) ++count;
  return count;
}

bool IsEmptyOrAbsent(const fs::path& folder) { return !fs::exists(folder) || fs::is_empty(folder); }

class Archives : public testing::Test {
 protected:
  Archives() {
    WriteEurocFolder(folder_.path() / "source" / "mav0");
    entries_ = EntriesOf(folder_.path() / "source" / "mav0", "drive one/mav0/");
    fs::create_directories(scratch_);
  }

  TestFolder folder_;
  const fs::path scratch_ = folder_.path() / "scratch";
  std::vector<Entry> entries_;
};

TEST_F(Archives, EveryKindHoldsTheSameDriveAsItsFolder) {
  const int expected = CountRecords(*OpenDriveLog(folder_.path() / "source"));
  for (const std::string kind : {"zip", "tar", "tar.gz", "tar.zst"}) {
    const fs::path file = folder_.path() / ("drive_" + kind);
    WriteArchive(file, kind, entries_);

    const auto log = OpenDriveLog(file, {.scratch_folder = scratch_});

    EXPECT_EQ(CountRecords(*log), expected) << kind;
    EXPECT_TRUE(log->health().damage.IsClean()) << kind;
  }
}

TEST_F(Archives, TheUnpackedFilesAreGoneWithTheLastPass) {
  const fs::path file = folder_.path() / "drive.zip";
  WriteArchive(file, "zip", entries_);
  auto log = OpenDriveLog(file, {.scratch_folder = scratch_});
  auto pass = log->Read({});
  log.reset();
  EXPECT_FALSE(IsEmptyOrAbsent(scratch_));

  pass.reset();

  EXPECT_TRUE(IsEmptyOrAbsent(scratch_));
}

TEST_F(Archives, NothingIsWrittenOutside) {
  const fs::path target = folder_.path() / "a" / "b" / "target",
                 outside = folder_.path() / "a" / "owned";
  const std::vector<std::vector<Entry>> attacks = {
      {{"../../owned", "x"}},
      {{"mav0/cam0/data/../../../../../owned", "x"}},
      {{outside.string(), "x"}},
      {{"mav0/cam0/data", "", AE_IFLNK, (folder_.path() / "a").string()},
       {"mav0/cam0/data/owned", "x"}},
      {{"mav0/cam0", "", AE_IFLNK, "../.."},
       {"mav0/cam0/data.csv", "x"},
       {"mav0/cam0/data/owned", "x"}},
      {{"mav0/cam0/data/a.png", "", AE_IFREG, "/etc/passwd"}},
      {{"mav0/cam0/data/..\\..\\owned", "x"}},
      {{"mav0/cam0/data/.owned", "x"}},
  };
  for (const std::string kind : {"tar", "zip"}) {
    for (std::size_t i = 0; i < attacks.size(); ++i) {
      if (kind == "zip" && i == 5) continue;  // zip has no hard links
      const fs::path file = folder_.path() / "attack";
      fs::create_directories(target);
      WriteArchive(file, kind, attacks[i]);

      WhatExtractionThrows(file, target);

      EXPECT_FALSE(fs::exists(outside)) << kind << i;
      EXPECT_FALSE(fs::exists(folder_.path() / "a" / "data.csv")) << kind << i;
      for (const auto& made : fs::recursive_directory_iterator(target))
        EXPECT_FALSE(made.is_symlink()) << kind << i << made.path();
      EXPECT_FALSE(fs::exists(target / "cam0" / "data" / "a.png"))
          << "a hard link has no content of its own";
      fs::remove_all(folder_.path() / "a");
    }
  }
}

TEST_F(Archives, ABombIsRefused) {
  const fs::path file = folder_.path() / "bomb.tar.gz";
  WriteArchive(file, "tar.gz", {{"mav0/imu0/data.csv", std::string(std::size_t{80} << 20, '0')}});
  ASSERT_LT(fs::file_size(file), 1u << 20);

  EXPECT_NE(WhatExtractionThrows(file, scratch_).find("8 times its size"), std::string::npos);
}

TEST_F(Archives, WhatIsNoDriveIsSaidInOneSentence) {
  const fs::path file = folder_.path() / "photos.zip";
  WriteArchive(file, "zip", {{"holiday/1.jpg", "x"}, {"cam0.csv", "x"}});
  EXPECT_EQ(WhatExtractionThrows(file, scratch_),
            "photos.zip holds no drive: neither EuRoC (mav0 with imu0, cam0, ...), KITTI raw "
            "(oxts, image_00, "
            "...) or images and tables (cam0, imu.csv, ...), nor log files (.bag, .mcap, .db3)");

  auto two = entries_;
  for (const Entry& entry : EntriesOf(folder_.path() / "source" / "mav0", "another/mav0/"))
    two.push_back(entry);
  WriteArchive(file, "zip", two);
  EXPECT_EQ(WhatExtractionThrows(file, scratch_),
            "photos.zip holds several EuRoC drives: give one of them");
}

TEST_F(Archives, ACutOneGivesWhatItHoldsAndSaysSo) {
  // The IMU first, so that the cut falls into the images.
  std::stable_partition(entries_.begin(), entries_.end(), [](const Entry& entry) {
    return entry.path.find("/data/") == std::string::npos;
  });
  const fs::path file = folder_.path() / "drive.tar";
  WriteArchive(file, "tar", entries_);
  fs::resize_file(file, fs::file_size(file) * 3 / 4 + 100);  // between two blocks

  const auto log = OpenDriveLog(file, {.scratch_folder = scratch_});

  EXPECT_GT(CountRecords(*log), 201);
  EXPECT_LT(CountRecords(*log), 201 + 42);
  EXPECT_TRUE(log->health().damage.is_truncated);
  EXPECT_TRUE(IsArchive(file));
}

TEST_F(Archives, EveryCutAndEveryFlipEndsInAnErrorOrInADrive) {
  const fs::path whole = folder_.path() / "drive.tar.gz", file = folder_.path() / "mutant";
  for (const std::string kind : {"tar.gz", "zip", "tar.zst"}) {
    WriteArchive(whole, kind, entries_);
    const std::string bytes = Slurp(whole);
    std::uint32_t random = 7;
    for (int trial = 0; trial < 60; ++trial) {
      std::string mutant = bytes;
      random = random * 1664525 + 1013904223;
      if (trial % 2 == 0)
        mutant.resize(random % mutant.size());
      else
        mutant[random % mutant.size()] = static_cast<char>(random >> 24);
      std::ofstream(file, std::ios::binary) << mutant;

      try {
        CountRecords(*OpenDriveLog(file, {.scratch_folder = scratch_}));
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::kInvalidInput) << error.what();
      }
      EXPECT_TRUE(IsEmptyOrAbsent(scratch_));
    }
  }
}

}  // namespace
}  // namespace parkade
