#include <gtest/gtest.h>
#include <malloc.h>

#include <fstream>
#include <sstream>

#include "server/ingest/containers/open_message_source.h"
#include "tests/server/ingest/containers/sample_log.h"
#include "tests/support/sanitizers.h"

namespace parkade {
namespace {

/// Memory of this process: "VmHWM", the most it ever held, or "VmRSS" [MiB].
double MemoryOf(const std::string& key) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with(key + ":")) return std::stod(line.substr(key.size() + 1)) / 1024;
  return 0;
}

/// How much more than now the process holds at most during `work` [MiB].
template <typename Work>
double PeakGrowthDuring(Work work) {
  ::malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5";  // sets VmHWM back to VmRSS
  const double before = MemoryOf("VmRSS");
  work();
  const double growth = MemoryOf("VmHWM") - before;
  testing::Test::RecordProperty("peak_growth_mib", std::to_string(growth));
  return growth;
}

std::size_t CountMessages(const std::filesystem::path& file) {
  const auto source = OpenMessageSource(file);
  const auto stream = source->Read(std::vector<bool>(source->topics().size(), true));
  std::size_t count = 0;
  while (stream->Next()) ++count;
  EXPECT_TRUE(stream->damage().IsClean());
  return count;
}

constexpr std::size_t kMessageSize = 1 << 20;
constexpr double kAllowed = 100;  // [MiB]: half of what the whole of reading may take

/// A sanitizer keeps up to 256 MiB of what was let go.
void ExpectLittle(double growth) {
  if (kHasSanitizer) return;
  EXPECT_LT(growth, kAllowed);
}

void WriteImages(const std::filesystem::path& file, int count, const McapWriterOptions& options) {
  McapWriter writer(file, "ros2", options);
  const int channel = writer.AddChannel("/cam0/image_raw", "sensor_msgs/msg/Image", "", "cdr");
  std::vector<std::uint8_t> image(kMessageSize);
  for (int i = 0; i < count; ++i) {
    image[static_cast<std::size_t>(i)] = 1;
    writer.Write(channel, {i * 10'000'000LL}, image);
  }
  writer.Close();
}

TEST(BoundedMemory, HoldsForALogOfManyChunks) {
  const ScratchFile file(".mcap");
  WriteImages(file.path(), 300,
              {.compression = LogCompression::kLz4, .chunk_size = 4 << 20, .has_checksums = false});

  std::size_t count = 0;
  const double growth = PeakGrowthDuring([&] { count = CountMessages(file.path()); });

  EXPECT_EQ(count, 300u);
  ExpectLittle(growth);
}

TEST(BoundedMemory, HoldsForOneChunkOfHundredsOfMegabytes) {
  const ScratchFile file(".mcap");
  WriteImages(file.path(), 250, {.compression = LogCompression::kLz4, .chunk_size = 400 << 20});

  std::size_t count = 0;
  const double growth = PeakGrowthDuring([&] { count = CountMessages(file.path()); });

  EXPECT_EQ(count, 250u);
  ExpectLittle(growth);

  // Far behind what is held at a time.
  const auto source = OpenMessageSource(file.path());
  const auto stream = source->Read({true});
  MessagePlace last;
  while (const auto message = stream->Next()) last = message->place;
  const auto again = source->ReadAt(0, last);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->data.size(), kMessageSize);
  EXPECT_EQ(again->data[249], 1);
}

// Every chunk claims to reach over the whole log: merging them would need all of them at once.
TEST(BoundedMemory, HoldsWhereEveryChunkOverlapsAllOthers) {
  const ScratchFile file(".mcap");
  {
    McapWriter writer(file.path(), "ros2",
                      {.compression = LogCompression::kLz4, .chunk_size = 8 << 20});
    const int channel = writer.AddChannel("/cam0/image_raw", "sensor_msgs/msg/Image", "", "cdr");
    const std::vector<std::uint8_t> image(kMessageSize);
    for (int chunk = 0; chunk < 30; ++chunk)
      for (int i = 0; i < 8; ++i)
        writer.Write(channel, {i == 0 ? 1 : (i == 7 ? 1'000'000 : chunk * 8 + i)}, image);
    writer.Close();
  }

  std::size_t count = 0;
  const double growth = PeakGrowthDuring([&] { count = CountMessages(file.path()); });

  EXPECT_EQ(count, 240u);
  ExpectLittle(growth);
}

TEST(BoundedMemory, AChunkThatClaimsTooMuchIsLostAndTold) {
  const ScratchFile file(".mcap");
  WriteImages(file.path(), 8, {.compression = LogCompression::kZstd, .chunk_size = 2 << 20});
  std::vector<std::uint8_t> bytes = ReadBytes(file.path());
  // The first chunk's unpacked size lies behind magic, header record, opcode, length and two times.
  const std::size_t chunk_begin = 8 + 9 + 4 + 4 + 4 + 7;
  ASSERT_EQ(bytes[chunk_begin], 6);
  bytes[chunk_begin + 9 + 16 + 5] = 1;  // 1 TiB
  file.Write(bytes);

  ReadLog log;
  const double growth = PeakGrowthDuring([&] { log = ReadWhole(file.path()); });

  EXPECT_EQ(log.num_wrong, 6u);  // none of them is of the sample
  EXPECT_EQ(log.damage.num_lost_messages, 2u);
  ExpectLittle(growth);
}

}  // namespace
}  // namespace parkade
