#include <gtest/gtest.h>

#include "tests/server/ingest/containers/sample_log.h"

namespace parkade {
namespace {

// The writers of tests/support, read back by the official readers and by ours.

void WriteSample(const std::filesystem::path& file, const std::string& profile,
                 const McapWriterOptions& options) {
  McapWriter writer(file, profile, options);
  const bool is_ros1 = profile == "ros1";
  for (const SampleTopic& topic : kSampleTopics) {
    std::string type = topic.type;
    if (!is_ros1) type.replace(type.find('/'), 1, "/msg/");
    writer.AddChannel(topic.topic, type, "uint8[] data", is_ros1 ? "ros1" : "cdr");
  }
  for (const SampleMessage& message : SampleMessages())
    writer.Write(static_cast<int>(message.topic), message.time, message.data);
  writer.Close();
}

TEST(McapWriter, IsReadByTheOfficialReader) {
  PARKADE_SKIP_WITHOUT(MakeSample("write_mcap.mjs", ".mcap", {}));
  const ScratchFile file(".mcap");
  for (const LogCompression compression :
       {LogCompression::kNone, LogCompression::kLz4, LogCompression::kZstd})
    for (const std::string profile : {"ros1", "ros2"}) {
      WriteSample(file.path(), profile, {.compression = compression, .chunk_size = 50'000});

      EXPECT_EQ(RunScript("read_mcap.mjs", {file.path(), "indexed"}), "710\n")
          << NameOf(compression) << profile;
      EXPECT_EQ(RunScript("read_mcap.mjs", {file.path(), "streamed"}), "710\n")
          << NameOf(compression) << profile;
      EXPECT_EQ(ReadWhole(file.path()).found, AllSamples());
    }
}

TEST(McapWriter, WithoutChunksOrSummaryIsReadByTheOfficialReader) {
  PARKADE_SKIP_WITHOUT(MakeSample("write_mcap.mjs", ".mcap", {}));
  const ScratchFile file(".mcap");
  for (const bool has_chunks : {false, true}) {
    WriteSample(file.path(), "ros2",
                {.has_chunks = has_chunks, .has_message_index = false, .has_summary = false});

    EXPECT_EQ(RunScript("read_mcap.mjs", {file.path(), "streamed"}), "710\n");
    EXPECT_EQ(ReadWhole(file.path()).found, AllSamples());
  }
}

TEST(Rosbag1Writer, IsReadByTheOfficialReader) {
  PARKADE_SKIP_WITHOUT(MakeSample("write_rosbag1.py", ".bag", {"none"}));
  const ScratchFile file(".bag");
  for (const LogCompression compression :
       {LogCompression::kNone, LogCompression::kLz4, LogCompression::kBz2}) {
    Rosbag1Writer writer(file.path(), {.compression = compression, .chunk_size = 50'000});
    for (const SampleTopic& topic : kSampleTopics)
      writer.AddChannel(topic.topic, topic.type, "uint8[] data",
                        "0123456789abcdef0123456789abcdef");
    for (const SampleMessage& message : SampleMessages())
      writer.Write(static_cast<int>(message.topic), message.time, message.data);
    writer.Close();

    EXPECT_EQ(RunScript("read_rosbag1.py", {file.path()}), "710\n") << NameOf(compression);
    EXPECT_EQ(ReadWhole(file.path()).found, AllSamples());
  }
}

TEST(Rosbag1Writer, WithoutCloseLeavesWhatACrashLeaves) {
  const ScratchFile file(".bag");
  {
    Rosbag1Writer writer(file.path(), {.compression = LogCompression::kLz4, .chunk_size = 50'000});
    for (const SampleTopic& topic : kSampleTopics)
      writer.AddChannel(topic.topic, topic.type, "", "*");
    for (const SampleMessage& message : SampleMessages())
      writer.Write(static_cast<int>(message.topic), message.time, message.data);
  }

  const ReadLog log = ReadWhole(file.path());

  EXPECT_TRUE(log.damage.is_truncated);
  EXPECT_EQ(log.topics.size(), 4u);
  EXPECT_GT(log.found.size(), 600u);
  EXPECT_EQ(log.num_wrong, 0u);
}

TEST(McapWriter, WithoutCloseLeavesWhatACrashLeaves) {
  const ScratchFile file(".mcap");
  {
    McapWriter writer(file.path(), "ros2",
                      {.compression = LogCompression::kZstd, .chunk_size = 50'000});
    for (const SampleTopic& topic : kSampleTopics)
      writer.AddChannel(topic.topic, topic.type, "", "cdr");
    for (const SampleMessage& message : SampleMessages())
      writer.Write(static_cast<int>(message.topic), message.time, message.data);
  }

  const ReadLog log = ReadWhole(file.path());

  EXPECT_TRUE(log.damage.is_truncated);
  EXPECT_GT(log.found.size(), 600u);
  EXPECT_EQ(log.NumFoundOf(0, log.found.size()), log.found.size());
}

}  // namespace
}  // namespace parkade
