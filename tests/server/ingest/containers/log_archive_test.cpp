#include <gtest/gtest.h>

#include "core/error.h"
#include "server/ingest/containers/open_log_source.h"
#include "server/ingest/files/archive_extraction.h"
#include "server/ingest/files/archive_paths.h"
#include "tests/server/ingest/containers/sample_log.h"
#include "tests/support/archive_writer.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

class LogArchives : public testing::Test {
 protected:
  LogArchives() {
    fs::create_directories(source_);
    fs::create_directories(scratch_);
  }
  ~LogArchives() override { fs::remove_all(folder_); }

  /// Samples [first, last) as an MCAP file of `source_`.
  void WritePart(const std::string& name, std::size_t first, std::size_t last) const {
    McapWriter writer(source_ / name, "ros2", {.chunk_size = 20'000});
    for (const SampleTopic& topic : kSampleTopics)
      writer.AddChannel(topic.topic, topic.type, "", "cdr");
    for (std::size_t i = first; i < last; ++i)
      writer.Write(static_cast<int>(SampleMessages()[i].topic), SampleMessages()[i].time,
                   SampleMessages()[i].data);
    writer.Close();
  }
  std::vector<Entry> SplitRecording() const {
    WritePart("drive_0.mcap", 0, 300);
    WritePart("drive_1.mcap", 300, 710);
    return EntriesOf(source_, "my drive/");
  }
  fs::path Packed(const std::string& kind, const std::vector<Entry>& entries) const {
    const fs::path file = folder_ / ("drive." + kind);
    WriteArchive(file, kind, entries);
    return file;
  }
  std::string ErrorOf(const std::vector<Entry>& entries) const {
    try {
      OpenLogSource(Packed("zip", entries), scratch_);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kInvalidInput);
      EXPECT_TRUE(fs::is_empty(scratch_));
      return error.what();
    }
    return "";
  }

  const fs::path folder_ = ScratchFile("-archives").path();
  const fs::path source_ = folder_ / "source", scratch_ = folder_ / "scratch";
};

TEST_F(LogArchives, OfEveryKindHoldASplitRecording) {
  const std::vector<Entry> entries = SplitRecording();
  for (const char* kind : {"zip", "tar", "tar.gz", "tar.zst"}) {
    {
      const auto source = OpenLogSource(Packed(kind, entries), scratch_);
      EXPECT_EQ(source->format(), "MCAP");
      const ReadLog log = ReadWhole(*source);
      EXPECT_EQ(log.found, AllSamples()) << kind;
      EXPECT_TRUE(log.damage.IsClean()) << kind;
    }
    EXPECT_TRUE(fs::is_empty(scratch_)) << "what was unpacked is gone with the source";
  }
}

TEST_F(LogArchives, AreReadByAPassThatOutlivesTheSource) {
  auto source = OpenLogSource(Packed("tar", SplitRecording()), scratch_);
  const auto stream = source->Read({true, true, true, true});
  source.reset();

  std::size_t count = 0;
  while (stream->Next()) ++count;

  EXPECT_EQ(count, 710u);
}

TEST_F(LogArchives, MayHoldOneLogAndFilesThatAreNone) {
  WritePart("drive.mcap", 0, 710);
  std::vector<Entry> entries = EntriesOf(source_, "");
  entries.push_back({"._drive.mcap", "what macOS puts beside a file"});
  entries.push_back({"notes/readme.txt", "notes"});
  entries.push_back({"latest.mcap", "", AE_IFLNK, "/etc/passwd"});
  entries.push_back({"other/linked.bag", "", AE_IFREG, "drive.mcap"});

  EXPECT_EQ(ReadWhole(*OpenLogSource(Packed("tar", entries), scratch_)).found, AllSamples());
}

TEST_F(LogArchives, MetadataOfTheFolderTellsWhichFilesBelong) {
  WritePart("drive_0.mcap", 0, 300);
  WritePart("other.mcap", 300, 500);
  std::ofstream(source_ / "metadata.yaml")
      << "rosbag2_bagfile_information:\n  relative_file_paths:\n    - drive_0.mcap\n"
         "    - drive_1.mcap\n";
  std::vector<Entry> entries = EntriesOf(source_, "drive/");
  entries.insert(entries.begin(), {"metadata.yaml", "of something else"});

  const ReadLog log = ReadWhole(*OpenLogSource(Packed("tar", entries), scratch_));

  EXPECT_EQ(log.found.size(), 300u);
  ASSERT_EQ(log.damage.ranges.size(), 1u);
  EXPECT_NE(log.damage.ranges[0].what.find("'drive_1.mcap'"), std::string::npos);
}

TEST_F(LogArchives, ForeignMetadataIsNotTakenForTheRecordings) {
  std::vector<Entry> entries = SplitRecording();
  entries.insert(entries.begin(), {"a/metadata.yaml",
                                   "rosbag2_bagfile_information:\n  relative_file_paths:\n    - "
                                   "drive_0.mcap\n"});

  EXPECT_EQ(ReadWhole(*OpenLogSource(Packed("tar", entries), scratch_)).found, AllSamples());
}

TEST_F(LogArchives, CutOffGiveWhatTheyHoldAndSaySo) {
  const fs::path file = Packed("tar", SplitRecording());
  fs::resize_file(file, fs::file_size(file) * 4 / 5);

  const ReadLog log = ReadWhole(*OpenLogSource(file, scratch_));

  EXPECT_GT(log.found.size(), 400u);
  EXPECT_LT(log.found.size(), 710u);
  EXPECT_EQ(log.num_wrong, 0u);
  EXPECT_TRUE(log.damage.is_truncated);
  EXPECT_TRUE(
      std::any_of(log.damage.ranges.begin(), log.damage.ranges.end(), [](const LostRange& range) {
        return range.what.starts_with("the archive cannot be read to its end: ");
      }));
}

TEST_F(LogArchives, WithoutOneDriveAreRefusedWithASentence) {
  const Entry euroc{"mav0/imu0/data.csv", "0"};
  const Entry bag{"logs/a.bag", "#ROSBAG V2.0\n"};
  EXPECT_EQ(ErrorOf({euroc, bag}),
            "drive.zip holds both an EuRoC drive and log files: give one of them");
  EXPECT_EQ(ErrorOf({bag, euroc}),
            "drive.zip holds both an EuRoC drive and log files: give one of them");
  EXPECT_EQ(ErrorOf({bag, {"b.bag", "x"}}),
            "drive.zip holds log files in several folders: give one of them");
  EXPECT_EQ(ErrorOf({{"metadata.yaml", "x"}}),
            "drive.zip holds no drive: neither EuRoC (mav0 with imu0, cam0, ...), KITTI raw (oxts, "
            "image_00, "
            "...) or images and tables (cam0, imu.csv, ...), nor log files (.bag, .mcap, .db3)");
  EXPECT_EQ(ErrorOf({{"a (1).bag", "x"}}),
            "drive.zip holds 'a (1).bag': the name of a log file is at most 128 letters, digits, "
            "dots, dashes and underscores");
  EXPECT_EQ(ErrorOf({{"a.bag", "nothing of the kind"}}),
            "'a.bag' is not a drive log: neither a ROS 1 bag, nor MCAP, nor rosbag2");
}

TEST_F(LogArchives, WriteNothingOutside) {
  const fs::path target = folder_ / "a" / "target", outside = folder_ / "a" / "owned.bag";
  const std::vector<std::vector<Entry>> attacks = {
      {{"../owned.bag", "x"}},
      {{outside.string(), "x"}},
      {{"logs", "", AE_IFLNK, ".."}, {"logs/owned.bag", "x"}},
      {{"attack", "", AE_IFLNK, ".."}, {"owned.bag", "x"}},
      {{"owned.bag", "", AE_IFLNK, outside.string()}, {"owned.bag", "x"}},
      {{"..\\owned.bag", "x"}},
      {{"logs/.owned.bag", "x"}},
  };
  for (std::size_t i = 0; i < attacks.size(); ++i) {
    fs::create_directories(target);
    const fs::path file = folder_ / "attack";
    WriteArchive(file, "tar", attacks[i]);
    try {
      ExtractArchive(file, target);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kInvalidInput) << i;
    }
    EXPECT_FALSE(fs::exists(outside)) << i;
    for (const auto& made : fs::recursive_directory_iterator(target))
      EXPECT_FALSE(made.is_symlink()) << i << made.path();
    fs::remove_all(folder_ / "a");
  }
}

TEST_F(LogArchives, AreBoundedBySize) {
  const Entry bomb{"drive.bag", std::string(std::size_t{80} << 20, '0')};
  const fs::path file = Packed("tar.gz", {bomb});
  try {
    OpenLogSource(file, scratch_);
    FAIL() << "a bomb was unpacked";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("8 times its size"), std::string::npos);
  }
}

TEST_F(LogArchives, AreJudgedByTheirPathsBeforehand) {
  const auto error_of = [](const std::vector<std::string>& paths) -> std::string {
    try {
      CheckHoldsDrive(paths, "the set");
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(error_of({"drive/a_0.bag", "drive/a_1.bag", "drive/notes.txt"}), "");
  EXPECT_EQ(error_of({"a_0.db3.zstd", "metadata.yaml"}), "");
  EXPECT_EQ(error_of({"mav0/imu0/data.csv", "mav0/cam0/data/1.png"}), "");
  EXPECT_EQ(error_of({"date/calib_cam_to_cam.txt", "date/run/image_02/timestamps.txt"}), "");
  EXPECT_EQ(error_of({"lot/imu.csv", "lot/cam0/1317042651.168.png"}), "");
  EXPECT_NE(error_of({"lot/imu.csv", "lot/notes.txt"}).find("holds no drive"), std::string::npos);
  EXPECT_EQ(error_of({"a.bag", "b/b.bag"}),
            "the set holds log files in several folders: give one of them");
  EXPECT_NE(error_of({"a.pdf", "b.pdf"}).find("the set holds no drive"), std::string::npos);
}

}  // namespace
}  // namespace parkade
