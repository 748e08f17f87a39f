#include "server/ingest/containers/open_message_source.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <map>
#include <set>

#include "core/error.h"
#include "tests/server/ingest/containers/sample_log.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

// A folder that is removed at the end.
class OpenMessageSourceTest : public testing::Test {
 protected:
  OpenMessageSourceTest() { fs::create_directories(folder_); }
  ~OpenMessageSourceTest() override { fs::remove_all(folder_); }

  void Write(const std::string& name, const std::vector<std::uint8_t>& bytes) const {
    std::ofstream stream(folder_ / name, std::ios::binary);
    stream.write(reinterpret_cast<const char*>(bytes.data()),
                 static_cast<std::streamsize>(bytes.size()));
  }
  void WriteText(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }

  /// Samples [first, last) of some topics as an MCAP file, by a clock that is ahead.
  void WritePart(const std::string& name, std::size_t first, std::size_t last,
                 const McapWriterOptions& options = {}, double ahead = 0,
                 const std::set<std::size_t>& topics = {0, 1, 2, 3}) const {
    McapWriter writer(folder_ / name, "ros2", options);
    std::map<std::size_t, int> channels;
    for (const std::size_t topic : topics)
      channels[topic] =
          writer.AddChannel(kSampleTopics[topic].topic, kSampleTopics[topic].type, "", "cdr");
    for (std::size_t i = first; i < last; ++i)
      if (const SampleMessage& sample = SampleMessages()[i]; topics.contains(sample.topic))
        writer.Write(channels[sample.topic], sample.time + ahead, sample.data);
    writer.Close();
  }

  /// Which samples the folder's messages are, in the order they come, whatever their times.
  std::vector<std::size_t> ReadSamples() const {
    const auto source = OpenMessageSource(folder_);
    const auto stream = source->Read(std::vector<bool>(source->topics().size(), true));
    std::vector<std::size_t> read;
    while (const std::optional<RawMessage> message = stream->Next()) {
      const auto sample =
          std::find_if(SampleMessages().begin(), SampleMessages().end(),
                       [&](const SampleMessage& known) { return known.data == message->data; });
      read.push_back(static_cast<std::size_t>(sample - SampleMessages().begin()));
    }
    return read;
  }

  static std::string ErrorOf(const fs::path& path) {
    try {
      OpenMessageSource(path);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }

  std::size_t NumTemporaryFiles() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(scratch_), {}));
  }

  const fs::path folder_ = ScratchFile("-folder").path();
  const fs::path scratch_ = folder_ / "scratch";
};

TEST_F(OpenMessageSourceTest, WhatAFileIsItsContentSays) {
  WritePart("drive.jpg", 0, 710);

  EXPECT_EQ(ReadWhole(folder_ / "drive.jpg").found, AllSamples());
}

TEST_F(OpenMessageSourceTest, OtherFilesAreRefusedByName) {
  WriteText("empty.bag", "");
  WriteText("notes.mcap", std::string(100'000, 'x'));
  WriteText("old.bag", "#ROSBAG V1.2\n");
  WriteText("fake.db3", "SQLite format 3");

  EXPECT_NE(ErrorOf(folder_ / "empty.bag").find("'empty.bag' is not a drive log"),
            std::string::npos);
  EXPECT_NE(ErrorOf(folder_ / "notes.mcap").find("'notes.mcap' is not a drive log"),
            std::string::npos);
  EXPECT_NE(ErrorOf(folder_ / "old.bag").find("'old.bag'"), std::string::npos);
  EXPECT_NE(ErrorOf(folder_ / "fake.db3").find("'fake.db3'"), std::string::npos);
  EXPECT_NE(ErrorOf(folder_ / "nothing").find("nothing"), std::string::npos);
  fs::create_directories(scratch_);
  EXPECT_NE(ErrorOf(scratch_).find("holds no drive log"), std::string::npos);
  for (const char* name : {"a", "b", "c", "d", "e"}) std::ofstream(scratch_ / name) << "no log";
  EXPECT_EQ(ErrorOf(scratch_),
            "none of the files 'a', 'b', 'c' and 2 others is a drive log: neither a ROS 1 bag, nor "
            "MCAP, nor rosbag2");
}

TEST_F(OpenMessageSourceTest, SplitFilesAreOneLogInOrderOfTime) {
  WritePart("drive_10.mcap", 500, 710);
  WritePart("drive_9.mcap", 0, 500);
  WriteText("readme.txt", "not a log");

  const ReadLog log = ReadWhole(folder_);

  EXPECT_EQ(log.found, AllSamples());
  EXPECT_EQ(log.topics.size(), 4u);
  EXPECT_EQ(log.topics[0].num_messages, 400u);
  EXPECT_TRUE(log.damage.IsClean());
}

TEST_F(OpenMessageSourceTest, SplitFilesWhoseClockWasSetBackComeOneAfterTheOther) {
  WritePart("drive_9.mcap", 0, 500);
  WritePart("drive_10.mcap", 500, 710, {}, -2.5);

  EXPECT_EQ(ReadSamples(), AllSamples());
}

TEST_F(OpenMessageSourceTest, SplitFilesOfEachSensorWhoseClockWasSetBackStayTogether) {
  const std::set<std::size_t> imu = {0, 2}, rest = {1, 3};
  WritePart("imu_0.mcap", 0, 500, {}, 0, imu);
  WritePart("imu_1.mcap", 500, 710, {}, -2.5, imu);
  WritePart("rest_0.mcap", 0, 500, {}, 0, rest);
  WritePart("rest_1.mcap", 500, 710, {}, -2.5, rest);

  EXPECT_EQ(ReadSamples(), AllSamples());
}

TEST_F(OpenMessageSourceTest, FilesOfWhichOneIsNotSplitStayMerged) {
  WritePart("imu_0.mcap", 0, 500, {}, 0, {0, 2});
  WritePart("imu_1.mcap", 500, 710, {}, -2.5, {0, 2});
  WritePart("rest.mcap", 0, 710, {}, 0, {1, 3});

  EXPECT_EQ(ReadSamples().size(), 710u);
  EXPECT_NE(ReadSamples(), AllSamples());
}

TEST_F(OpenMessageSourceTest, FilesOfTwoRecordersAreMerged) {
  WritePart("one.mcap", 0, 500);
  WritePart("other.mcap", 20, 710, {}, 0.004);

  const std::vector<std::size_t> read = ReadSamples();

  EXPECT_EQ(read.size(), 500u + 690u);
  for (std::size_t i = 1; i < read.size(); ++i) EXPECT_LT(read[i - 1], read[i] + 10);
}

TEST_F(OpenMessageSourceTest, FilesOfOneDriveSideBySideAreMerged) {
  for (std::size_t topic = 0; topic < 4; ++topic) {
    McapWriter writer(folder_ / ("sensor" + std::to_string(topic)), "ros2", {.chunk_size = 20'000});
    const int channel =
        writer.AddChannel(kSampleTopics[topic].topic, kSampleTopics[topic].type, "", "cdr");
    for (const SampleMessage& message : SampleMessages())
      if (message.topic == topic) writer.Write(channel, message.time, message.data);
    writer.Close();
  }

  EXPECT_EQ(ReadWhole(folder_).found, AllSamples());
}

TEST_F(OpenMessageSourceTest, MetadataTellsWhichFilesBelongAndWhichAreMissing) {
  WritePart("drive_0.mcap", 0, 300);
  WritePart("unrelated.mcap", 300, 500);
  WriteText("metadata.yaml",
            "rosbag2_bagfile_information:\n  relative_file_paths:\n    - drive_0.mcap\n    - "
            "drive_1.mcap\n");

  const ReadLog log = ReadWhole(folder_);

  EXPECT_EQ(log.found.size(), 300u);
  ASSERT_EQ(log.damage.ranges.size(), 1u);
  EXPECT_NE(log.damage.ranges[0].what.find("'drive_1.mcap'"), std::string::npos);
}

TEST_F(OpenMessageSourceTest, NamedFilesWithADamagedHeadGiveWhatTheyHold) {
  WritePart("drive_0.mcap", 0, 300);
  WritePart("drive_1.mcap", 300, 710);
  WriteText("drive_2.mcap", "");
  std::fstream(folder_ / "drive_1.mcap", std::ios::in | std::ios::out | std::ios::binary)
      .write("\0\0\0\0\0\0\0\0", 8);
  WriteText("metadata.yaml",
            "rosbag2_bagfile_information:\n  relative_file_paths:\n    - drive_0.mcap\n    - "
            "drive_1.mcap\n    - "
            "drive_2.mcap\n");

  const ReadLog log = ReadWhole(folder_);

  EXPECT_EQ(log.found, AllSamples());
  EXPECT_TRUE(
      std::any_of(log.damage.ranges.begin(), log.damage.ranges.end(), [](const LostRange& range) {
        return range.what.find("'drive_2.mcap'") != std::string::npos;
      }));
}

TEST_F(OpenMessageSourceTest, BrokenMetadataIsDoneWithout) {
  WritePart("drive_0.mcap", 0, 710);
  WriteText("metadata.yaml", "rosbag2_bagfile_information: [[[\n\t{");

  EXPECT_EQ(ReadWhole(folder_).found, AllSamples());
}

TEST_F(OpenMessageSourceTest, FilesPackedAsAWholeAreUnpackedAndLeaveNothingBehind) {
  fs::create_directories(scratch_);
  const auto database = MakeSample("write_rosbag2.py", ".db3", {});
  PARKADE_SKIP_WITHOUT(database);
  WritePart("plain.mcap", 0, 710);
  Write("drive.db3.zstd", Compress(ReadBytes(database->path), LogCompression::kZstd));
  Write("drive.mcap.zstd", Compress(ReadBytes(folder_ / "plain.mcap"), LogCompression::kZstd));
  for (const char* name : {"drive.db3.zstd", "drive.mcap.zstd"}) {
    {
      const auto source = OpenMessageSource(folder_ / name, scratch_);
      EXPECT_EQ(NumTemporaryFiles(), 1u);
      EXPECT_EQ(ReadWhole(*source).found, AllSamples());
    }
    EXPECT_EQ(NumTemporaryFiles(), 0u);
  }
}

TEST_F(OpenMessageSourceTest, APassOutlivesItsSource) {
  fs::create_directories(scratch_);
  const auto database = MakeSample("write_rosbag2.py", ".db3", {});
  PARKADE_SKIP_WITHOUT(database);
  Write("drive.db3.zstd", Compress(ReadBytes(database->path), LogCompression::kZstd));
  auto source = OpenMessageSource(folder_ / "drive.db3.zstd", scratch_);
  const auto stream = source->Read({true, true, true, true});
  source.reset();

  std::size_t count = 0;
  while (stream->Next()) ++count;

  EXPECT_EQ(count, 710u);
}

TEST_F(OpenMessageSourceTest, APackedFileThatIsCutOffIsReadUpToThere) {
  fs::create_directories(scratch_);
  WritePart("plain.mcap", 0, 710, {.chunk_size = 20'000});
  std::vector<std::uint8_t> packed =
      Compress(ReadBytes(folder_ / "plain.mcap"), LogCompression::kZstd);
  packed.resize(packed.size() * 4 / 5);
  Write("drive.zstd", packed);

  const ReadLog log = ReadWhole(*OpenMessageSource(folder_ / "drive.zstd", scratch_));

  EXPECT_GT(log.found.size(), 300u);
  EXPECT_EQ(log.num_wrong, 0u);
  EXPECT_TRUE(log.damage.is_truncated);
}

TEST_F(OpenMessageSourceTest, ALogWhoseBeginningIsGoneIsKnownByItsRecords) {
  for (const auto& [script, extension] :
       {std::pair("write_rosbag1.py", ".bag"), std::pair("write_mcap.mjs", ".mcap")}) {
    const bool is_bag = std::string(extension) == ".bag";
    const auto sample = MakeSample(script, extension, {is_bag ? "lz4" : "compression=lz4"});
    PARKADE_SKIP_WITHOUT(sample);
    std::vector<std::uint8_t> bytes = ReadBytes(sample->path);
    std::fill_n(bytes.begin(), 8192, std::uint8_t{0});
    Write("headless", bytes);

    const ReadLog log = ReadWhole(folder_ / "headless");

    EXPECT_EQ(log.NumFoundOf(sample->chunks[0].num_messages, 710),
              710 - sample->chunks[0].num_messages);
    EXPECT_FALSE(log.damage.IsClean());
  }
}

// Logs of the official recorders, which lie beside the project (never in it).
class RecordedLogs : public testing::Test {
 protected:
  void SetUp() override {
    const char* shared = std::getenv("PARKADE_SHARED_DATA");
    data_ = shared != nullptr ? fs::path(shared) : fs::path("../shared/data");
    if (!fs::exists(data_ / "rosbag1"))
      GTEST_SKIP() << "needs PARKADE_SHARED_DATA or ../shared/data";
  }

  struct Counted {
    std::uint64_t num_messages = 0;
    std::size_t num_topics = 0;
    std::string format;
    bool is_clean = false;
  };
  static Counted Count(const fs::path& log) {
    const auto source = OpenMessageSource(log);
    const auto stream = source->Read(std::vector<bool>(source->topics().size(), true));
    Counted counted{0, source->topics().size(), source->format(), false};
    Timestamp last;
    while (const auto message = stream->Next()) {
      EXPECT_LE(last, message->log_time);
      last = message->log_time;
      ++counted.num_messages;
    }
    std::uint64_t num_promised = 0;
    for (const TopicInfo& topic : source->topics()) num_promised += topic.num_messages;
    EXPECT_EQ(counted.num_messages, num_promised) << log;
    counted.is_clean = stream->damage().IsClean();
    return counted;
  }

  fs::path data_;
};

TEST_F(RecordedLogs, AnLz4BagOfRos1IsReadWhole) {
  const Counted counted = Count(data_ / "rosbag1/example-lz4.bag");

  EXPECT_EQ(counted.format, "ROS 1 bag");
  EXPECT_GT(counted.num_messages, 100u);
  EXPECT_TRUE(counted.is_clean);
}

TEST_F(RecordedLogs, BagsOfRos2HoldTheSameInBothFormats) {
  for (const char* name :
       {"convert_a", "convert_b", "talker", "wbag", "reindex_test_bags/multiple_files"}) {
    const Counted mcap = Count(data_ / "rosbag2/mcap" / name);
    const Counted sqlite = Count(data_ / "rosbag2/sqlite3" / name);

    EXPECT_EQ(mcap.format, "MCAP");
    EXPECT_EQ(sqlite.format, "rosbag2 sqlite3");
    EXPECT_GT(mcap.num_messages, 0u) << name;
    EXPECT_EQ(mcap.num_topics, sqlite.num_topics) << name;
    EXPECT_TRUE(mcap.is_clean) << name;
    EXPECT_TRUE(sqlite.is_clean) << name;
  }
}

}  // namespace
}  // namespace parkade
