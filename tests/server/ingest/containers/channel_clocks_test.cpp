#include "server/ingest/containers/channel_clocks.h"

#include <gtest/gtest.h>

#include "server/ingest/containers/open_log_source.h"
#include "tests/server/ingest/containers/sample_log.h"

namespace parkade {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::size_t kMiddle = 355;  // of the sample: after 2.2 s
constexpr std::int64_t kSetBack = 3 * kSecond;

Timestamp At(double seconds) { return {static_cast<std::int64_t>(seconds * kSecond)}; }

TEST(ChannelClocks, GoingBackTogetherWereSetBack) {
  ChannelClocks clocks;
  for (int i = 0; i < 100; ++i)
    for (const std::uint32_t channel : {0u, 1u}) clocks.Add(channel, At(i < 50 ? i : i - 10));

  EXPECT_TRUE(clocks.WereSetBack());
}

TEST(ChannelClocks, OfOneChannelAloneAreNoneOfTheRecorder) {
  ChannelClocks clocks;
  for (int i = 0; i < 100; ++i) {
    clocks.Add(0, At(i < 50 ? i : i - 10));
    clocks.Add(1, At(i));
    clocks.Add(2, At(i));
  }

  EXPECT_FALSE(clocks.WereSetBack());
}

TEST(ChannelClocks, BehindEachOtherOrInDisorderWereNotSetBack) {
  ChannelClocks behind_each_other, late, chaos;
  for (const std::uint32_t channel : {0u, 1u})
    for (int i = 0; i < 100; ++i) behind_each_other.Add(channel, At(i));
  for (int i = 0; i < 100; ++i) late.Add(0, At(0.1 * (i % 7 == 0 ? i - 15 : i) + 10));
  for (int i = 0; i < 100; ++i) chaos.Add(0, At(37 * i % 100));

  EXPECT_FALSE(behind_each_other.WereSetBack());
  EXPECT_FALSE(late.WereSetBack());
  EXPECT_FALSE(chaos.WereSetBack());
}

// The sample, its recorder's clock set back in the middle: by time, half of it would be mixed.
class LogOfAClockSetBack : public testing::Test {
 protected:
  static Timestamp TimeOf(std::size_t i) {
    return {SampleMessages()[i].time.ns - (i < kMiddle ? 0 : kSetBack)};
  }

  template <typename Writer>
  void Write(Writer& writer, const char* encoding) const {
    for (const SampleTopic& topic : kSampleTopics)
      writer.AddChannel(topic.topic, topic.type, "", encoding);
    for (std::size_t i = 0; i < SampleMessages().size(); ++i)
      writer.Write(static_cast<int>(SampleMessages()[i].topic), TimeOf(i),
                   SampleMessages()[i].data);
    writer.Close();
  }

  static void ExpectTheOrderOfTheFile(const ScratchFile& file) {
    const auto source = OpenLogSource(file.path(), std::filesystem::temp_directory_path());
    const auto stream = source->Read(std::vector<bool>(source->topics().size(), true));
    for (std::size_t i = 0; i < SampleMessages().size(); ++i) {
      const std::optional<RawMessage> message = stream->Next();
      ASSERT_TRUE(message.has_value());
      ASSERT_EQ(message->log_time, TimeOf(i)) << "message " << i;
    }
    EXPECT_FALSE(stream->Next().has_value());
    EXPECT_TRUE(stream->damage().IsClean());
  }
};

TEST_F(LogOfAClockSetBack, IsReadInTheOrderOfTheFileAsMcap) {
  for (const std::size_t chunk_size : {20'000, 1 << 20}) {
    const ScratchFile file(".mcap");
    McapWriter writer(file.path(), "ros2", {.chunk_size = chunk_size});
    Write(writer, "cdr");
    ExpectTheOrderOfTheFile(file);
  }
}

TEST_F(LogOfAClockSetBack, IsReadInTheOrderOfTheFileAsBag) {
  const ScratchFile file(".bag");
  Rosbag1Writer writer(file.path(), {.chunk_size = 20'000});
  Write(writer, "*");
  ExpectTheOrderOfTheFile(file);
}

TEST_F(LogOfAClockSetBack, IsReadInTheOrderOfItsRowsAsDatabase) {
  const ScratchFile file(".db3");
  if (!RunScript("write_rosbag2.py", {file.path().string(), "set_back=3"}))
    GTEST_SKIP() << "needs python3";
  ExpectTheOrderOfTheFile(file);
}

}  // namespace
}  // namespace parkade
