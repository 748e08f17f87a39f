#include <gtest/gtest.h>

#include "server/ingest/containers/open_message_source.h"
#include "tests/server/ingest/containers/sample_log.h"

namespace parkade {
namespace {

struct Sample {
  const char* name;
  const char* script;
  const char* extension;
  std::vector<std::string> arguments;
  const char* format;
  MessageEncoding encoding;
};

void PrintTo(const Sample& sample, std::ostream* out) { *out << sample.name; }

class OfficialLogs : public testing::TestWithParam<Sample> {};

TEST_P(OfficialLogs, AreReadWholeAndInOrderOfTime) {
  const Sample& param = GetParam();
  const auto sample = MakeSample(param.script, param.extension, param.arguments);
  PARKADE_SKIP_WITHOUT(sample);

  const auto source = OpenMessageSource(sample->path);
  const ReadLog log = ReadWhole(*source);

  EXPECT_EQ(source->format(), param.format);
  EXPECT_EQ(log.found, AllSamples());
  EXPECT_EQ(log.num_wrong, 0u);
  EXPECT_EQ(log.num_misplaced, 0u);
  EXPECT_TRUE(log.damage.IsClean());
}

TEST_P(OfficialLogs, TopicsHaveTheirRos1TypesAndCounts) {
  const Sample& param = GetParam();
  const auto sample = MakeSample(param.script, param.extension, param.arguments);
  PARKADE_SKIP_WITHOUT(sample);

  const auto source = OpenMessageSource(sample->path);

  ASSERT_EQ(source->topics().size(), kSampleTopics.size());
  for (const TopicInfo& topic : source->topics()) {
    const auto expected =
        std::find_if(kSampleTopics.begin(), kSampleTopics.end(),
                     [&](const SampleTopic& candidate) { return candidate.topic == topic.topic; });
    ASSERT_NE(expected, kSampleTopics.end()) << topic.topic;
    EXPECT_EQ(topic.type, expected->type);
    EXPECT_EQ(topic.encoding, param.encoding);
    EXPECT_EQ(topic.num_messages,
              static_cast<std::uint64_t>((400 - expected->begin) / expected->period));
  }
}

TEST_P(OfficialLogs, UnwantedTopicsAreLeftOut) {
  const Sample& param = GetParam();
  const auto sample = MakeSample(param.script, param.extension, param.arguments);
  PARKADE_SKIP_WITHOUT(sample);
  const auto source = OpenMessageSource(sample->path);
  std::vector<bool> wanted(source->topics().size());
  for (std::size_t i = 0; i < wanted.size(); ++i) wanted[i] = source->topics()[i].topic == "/odom";

  const auto stream = source->Read(wanted);
  std::size_t count = 0;
  while (const auto message = stream->Next()) {
    EXPECT_TRUE(FindSample("/odom", *message));
    ++count;
  }

  EXPECT_EQ(count, 200u);
}

constexpr auto kRos1 = MessageEncoding::kRos1;
constexpr auto kCdr = MessageEncoding::kCdr;

INSTANTIATE_TEST_SUITE_P(
    Rosbag1, OfficialLogs,
    testing::Values(Sample{"Plain", "write_rosbag1.py", ".bag", {"none"}, "ROS 1 bag", kRos1},
                    Sample{"Bz2", "write_rosbag1.py", ".bag", {"bz2"}, "ROS 1 bag", kRos1},
                    Sample{"Lz4", "write_rosbag1.py", ".bag", {"lz4"}, "ROS 1 bag", kRos1}),
    [](const auto& info) { return info.param.name; });

INSTANTIATE_TEST_SUITE_P(
    Mcap, OfficialLogs,
    testing::Values(
        Sample{"Plain", "write_mcap.mjs", ".mcap", {}, "MCAP", kCdr},
        Sample{"Lz4", "write_mcap.mjs", ".mcap", {"compression=lz4"}, "MCAP", kCdr},
        Sample{"Zstd", "write_mcap.mjs", ".mcap", {"compression=zstd"}, "MCAP", kCdr},
        Sample{
            "Ros1", "write_mcap.mjs", ".mcap", {"profile=ros1", "compression=lz4"}, "MCAP", kRos1},
        Sample{"NoSummary",
               "write_mcap.mjs",
               ".mcap",
               {"compression=zstd", "summary=no"},
               "MCAP",
               kCdr},
        Sample{
            "NoIndex", "write_mcap.mjs", ".mcap", {"compression=zstd", "index=no"}, "MCAP", kCdr},
        Sample{"NoIndexNorSummary",
               "write_mcap.mjs",
               ".mcap",
               {"index=no", "summary=no"},
               "MCAP",
               kCdr},
        Sample{"NoChunks", "write_mcap.mjs", ".mcap", {"chunks=no"}, "MCAP", kCdr},
        Sample{"NoChunksNorSummary",
               "write_mcap.mjs",
               ".mcap",
               {"chunks=no", "summary=no"},
               "MCAP",
               kCdr},
        Sample{"OverlappingChunks",
               "write_mcap.mjs",
               ".mcap",
               {"compression=lz4", "order=swapped"},
               "MCAP",
               kCdr},
        Sample{
            "Scattered", "write_mcap.mjs", ".mcap", {"chunks=no", "order=swapped"}, "MCAP", kCdr}),
    [](const auto& info) { return info.param.name; });

INSTANTIATE_TEST_SUITE_P(
    Rosbag2, OfficialLogs,
    testing::Values(
        Sample{"Plain", "write_rosbag2.py", ".db3", {}, "rosbag2 sqlite3", kCdr},
        Sample{"PackedMessages",
               "write_rosbag2.py",
               ".db3",
               {"messages=zstd"},
               "rosbag2 sqlite3",
               kCdr},
        Sample{"NoIndex", "write_rosbag2.py", ".db3", {"index=no"}, "rosbag2 sqlite3", kCdr}),
    [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace parkade
