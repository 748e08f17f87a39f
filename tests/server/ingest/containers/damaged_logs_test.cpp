#include <gtest/gtest.h>

#include <map>
#include <numeric>
#include <random>

#include "tests/server/ingest/containers/sample_log.h"

namespace parkade {
namespace {

struct Sample {
  const char* name;
  const char* script;
  const char* extension;
  std::vector<std::string> arguments;
  bool has_checksums;  ///< of chunks: no damaged message may come through
  bool has_spare_definitions =
      true;  ///< topics are defined in more than the chunk where they begin
  int num_trials =
      40;  ///< of each kind of random damage; fewer where unpacking takes half a second
};

void PrintTo(const Sample& sample, std::ostream* out) { *out << sample.name; }

// A sample, and where its chunks are; files without chunks have none.
class DamagedLogs : public testing::TestWithParam<Sample> {
 protected:
  void SetUp() override {
    sample_ = MakeSample(GetParam().script, GetParam().extension, GetParam().arguments);
    PARKADE_SKIP_WITHOUT(sample_);
    ASSERT_GT(sample_->chunks.size(), 8u);
    bytes_ = ReadBytes(sample_->path);
  }

  ReadLog ReadMutant(const std::vector<std::uint8_t>& bytes) const {
    file_.Write(bytes);
    return ReadWhole(file_.path());
  }

  /// Messages of chunks that lie whole before `begin` or begin at `end` or later must all be there;
  /// the index of the chunk that is hit counts as part of it.
  void ExpectTheRestIsThere(const ReadLog& log, std::uint64_t begin, std::uint64_t end) const {
    const bool hits_definitions =
        begin < sample_->chunks.front().end || log.topics.size() < kSampleTopics.size();
    std::size_t first = 0;
    for (const SampleChunk& chunk : sample_->chunks) {
      if (hits_definitions && !GetParam().has_spare_definitions) break;
      if (chunk.end <= begin || chunk.begin >= end) {
        EXPECT_EQ(log.NumFoundOf(first, chunk.num_messages), chunk.num_messages)
            << "chunk at " << chunk.begin << ", damage at " << begin << ".." << end;
      }
      first += chunk.num_messages;
    }
    if (GetParam().has_checksums) {
      EXPECT_EQ(log.num_wrong, 0u) << "damage at " << begin << ".." << end;
    }
    EXPECT_LE(log.num_wrong, 1 + (end - begin) / 100) << "damage at " << begin << ".." << end;
    EXPECT_EQ(log.found.size(), log.NumFoundOf(0, SampleMessages().size()))
        << "a message came twice";
  }

  /// Whoever loses messages says so, and says how many where indexes tell.
  static void ExpectLossesAreTold(const ReadLog& log, const std::string& where) {
    const std::size_t num_missing = SampleMessages().size() - log.found.size() - log.num_wrong;
    if (num_missing == 0) return;
    EXPECT_FALSE(log.damage.IsClean()) << where;
    EXPECT_LE(log.damage.num_lost_messages, num_missing + 2) << where;
  }

  std::optional<SampleFile> sample_;
  std::vector<std::uint8_t> bytes_;
  ScratchFile file_{".log"};
};

std::vector<std::uint8_t> CutAt(const std::vector<std::uint8_t>& bytes, std::uint64_t size) {
  return {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)};
}

TEST_P(DamagedLogs, CutAtEveryChunkBoundaryGiveAllBefore) {
  for (const SampleChunk& chunk : sample_->chunks)
    for (const std::uint64_t boundary : {chunk.begin, chunk.end})
      for (const std::uint64_t size : {boundary - 1, boundary, boundary + 1}) {
        const ReadLog log = ReadMutant(CutAt(bytes_, size));

        EXPECT_TRUE(log.damage.is_truncated) << "cut at " << size;
        EXPECT_EQ(log.num_wrong, 0u) << "cut at " << size;
        ExpectTheRestIsThere(log, size, bytes_.size());
      }
}

TEST_P(DamagedLogs, CutAnywhereGiveAllBefore) {
  std::mt19937 random(1);
  std::uniform_int_distribution<std::uint64_t> any(4200, bytes_.size() - 1);
  for (int trial = 0; trial < GetParam().num_trials; ++trial) {
    const std::uint64_t size = any(random);
    const ReadLog log = ReadMutant(CutAt(bytes_, size));

    EXPECT_TRUE(log.damage.is_truncated) << "cut at " << size;
    EXPECT_EQ(log.num_wrong, 0u) << "cut at " << size;
    ExpectTheRestIsThere(log, size, bytes_.size());
    // Messages follow each other without gaps up to the last.
    std::vector<std::size_t> expected(log.found.size());
    std::iota(expected.begin(), expected.end(), std::size_t{0});
    EXPECT_EQ(log.found, expected) << "cut at " << size;
  }
}

TEST_P(DamagedLogs, WithAFlippedBitLoseOneChunkAtMost) {
  std::mt19937 random(2);
  std::uniform_int_distribution<std::uint64_t> any(0, bytes_.size() - 1);
  for (int trial = 0; trial < GetParam().num_trials; ++trial) {
    const std::uint64_t place = any(random);
    std::vector<std::uint8_t> mutant = bytes_;
    mutant[place] ^= static_cast<std::uint8_t>(1u << (random() % 8));
    const ReadLog log = ReadMutant(mutant);

    ExpectTheRestIsThere(log, place, place + 1);
    ExpectLossesAreTold(log, "bit at " + std::to_string(place));
  }
}

TEST_P(DamagedLogs, WithASectorOfZerosLoseOnlyWhatItHit) {
  std::mt19937 random(3);
  for (int trial = 0; trial < GetParam().num_trials; ++trial) {
    const std::uint64_t size = std::uint64_t{64} << (random() % 7);
    const std::uint64_t begin = random() % (bytes_.size() - size);
    std::vector<std::uint8_t> mutant = bytes_;
    std::fill_n(mutant.begin() + static_cast<std::ptrdiff_t>(begin), size, std::uint8_t{0});
    const ReadLog log = ReadMutant(mutant);

    ExpectTheRestIsThere(log, begin, begin + size);
    ExpectLossesAreTold(log, "zeros at " + std::to_string(begin) + ", " + std::to_string(size));
  }
}

TEST_P(DamagedLogs, WithBytesTakenOutLoseOnlyWhatWasThere) {
  std::mt19937 random(4);
  for (int trial = 0; trial < GetParam().num_trials; ++trial) {
    const std::uint64_t size = 1 + random() % 3000;
    const std::uint64_t begin = 200 + random() % (bytes_.size() - size - 200);
    std::vector<std::uint8_t> mutant = bytes_;
    const auto first = mutant.begin() + static_cast<std::ptrdiff_t>(begin);
    mutant.erase(first, first + static_cast<std::ptrdiff_t>(size));
    const ReadLog log = ReadMutant(mutant);

    ExpectTheRestIsThere(log, begin, begin + size);
    ExpectLossesAreTold(log, "without " + std::to_string(size) + " at " + std::to_string(begin));
  }
}

TEST_P(DamagedLogs, WithForeignBytesInsideLoseOneChunkAtMost) {
  std::mt19937 random(5);
  for (int trial = 0; trial < GetParam().num_trials; ++trial) {
    const std::uint64_t place = 200 + random() % (bytes_.size() - 200);
    std::vector<std::uint8_t> foreign(1 + random() % 3000);
    for (std::uint8_t& byte : foreign) byte = static_cast<std::uint8_t>(random());
    std::vector<std::uint8_t> mutant = bytes_;
    mutant.insert(mutant.begin() + static_cast<std::ptrdiff_t>(place), foreign.begin(),
                  foreign.end());
    const ReadLog log = ReadMutant(mutant);

    ExpectTheRestIsThere(log, place, place + 1);
    ExpectLossesAreTold(log, "foreign bytes at " + std::to_string(place));
  }
}

// With an index behind each chunk the count of what was lost is exact, topic by topic, with its
// times.
TEST_P(DamagedLogs, TellExactlyWhatADamagedChunkHeld) {
  if (!GetParam().has_checksums) GTEST_SKIP() << "nothing tells that such a chunk is damaged";
  std::size_t first = 0;
  for (const SampleChunk& chunk : sample_->chunks) {
    std::vector<std::uint8_t> mutant = bytes_;
    mutant[(chunk.begin + chunk.end) / 2] ^= 0x10;
    const ReadLog log = ReadMutant(mutant);

    std::map<std::string, std::uint64_t> num_lost;
    for (const LostRange& range : log.damage.ranges) {
      num_lost[range.topic] += range.num_messages;
      EXPECT_EQ(range.time.IsEmpty(), false);
      EXPECT_GE(range.time.begin, SampleMessages()[first].time);
      EXPECT_LE(range.time.end, SampleMessages()[first + chunk.num_messages - 1].time);
    }
    std::map<std::string, std::uint64_t> expected;
    for (std::size_t i = first; i < first + chunk.num_messages; ++i)
      ++expected[kSampleTopics[SampleMessages()[i].topic].topic];
    EXPECT_EQ(num_lost, expected) << "chunk at " << chunk.begin;
    EXPECT_EQ(log.damage.num_lost_messages, chunk.num_messages);
    EXPECT_EQ(log.found.size(), SampleMessages().size() - chunk.num_messages);
    first += chunk.num_messages;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Formats, DamagedLogs,
    testing::Values(Sample{"BagPlain", "write_rosbag1.py", ".bag", {"none"}, false},
                    Sample{"BagLz4", "write_rosbag1.py", ".bag", {"lz4"}, true},
                    Sample{"BagBz2", "write_rosbag1.py", ".bag", {"bz2"}, true, true, 4},
                    Sample{"McapPlain", "write_mcap.mjs", ".mcap", {}, true},
                    Sample{"McapLz4", "write_mcap.mjs", ".mcap", {"compression=lz4"}, true},
                    Sample{"McapZstd", "write_mcap.mjs", ".mcap", {"compression=zstd"}, true},
                    Sample{"McapNoSummary",
                           "write_mcap.mjs",
                           ".mcap",
                           {"compression=zstd", "summary=no"},
                           true,
                           false}),
    [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace parkade
