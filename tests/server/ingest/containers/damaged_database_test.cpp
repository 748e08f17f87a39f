#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <memory>
#include <random>

#include "server/ingest/containers/open_message_source.h"
#include "server/ingest/containers/sqlite_pages.h"
#include "tests/server/ingest/containers/sample_log.h"

namespace parkade {
namespace {

constexpr std::size_t kPage = 4096;
constexpr std::size_t kMostPerPage = 13;  // messages of 320 byte

// SQLite's own checks end a query at the first damaged page: what lies behind it must come all the
// same.
class DamagedDatabase : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    std::vector<std::string> arguments;
    if (*GetParam() != '\0') arguments.emplace_back(GetParam());
    sample_ = MakeSample("write_rosbag2.py", ".db3", arguments);
    PARKADE_SKIP_WITHOUT(sample_);
    bytes_ = ReadBytes(sample_->path);
  }

  ReadLog ReadMutant(const std::vector<std::uint8_t>& bytes) const {
    file_.Write(bytes);
    const ReadLog log = ReadWhole(file_.path());
    EXPECT_EQ(log.found.size(), log.NumFoundOf(0, 710)) << "a message came twice";
    return log;
  }

  std::optional<SampleFile> sample_;
  std::vector<std::uint8_t> bytes_;
  ScratchFile file_{".db3"};
};

TEST_P(DamagedDatabase, WithAPageOfZerosLosesOnlyThatPage) {
  // The tables' own pages come first; without their names there is no log.
  for (std::size_t page = 12; page < bytes_.size() / kPage; ++page) {
    std::vector<std::uint8_t> mutant = bytes_;
    std::fill_n(mutant.begin() + static_cast<std::ptrdiff_t>(page * kPage), kPage, std::uint8_t{0});
    const ReadLog log = ReadMutant(mutant);

    EXPECT_GE(log.found.size() + kMostPerPage, 710u) << "page " << page;
    EXPECT_LE(log.num_wrong, 1u) << "page " << page;  // the middle of a large message
    if (log.found.size() + log.num_wrong < 710) {
      EXPECT_FALSE(log.damage.IsClean()) << "page " << page;
    }
  }
}

TEST_P(DamagedDatabase, CutAnywhereGivesAboutAllBefore) {
  std::mt19937 random(6);
  for (int trial = 0; trial < 40; ++trial) {
    const std::size_t size = 20 * kPage + random() % (bytes_.size() - 20 * kPage);
    const ReadLog log =
        ReadMutant({bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(size)});

    EXPECT_TRUE(log.damage.is_truncated);
    EXPECT_EQ(log.num_wrong, 0u);
    // Messages lie about evenly in the file, but for its index, which is written with them.
    const double share = static_cast<double>(size) / static_cast<double>(bytes_.size());
    EXPECT_GE(static_cast<double>(log.found.size()), 710 * share * 0.9 - 20) << "cut at " << size;
  }
}

TEST_P(DamagedDatabase, WithAFlippedBitLosesOnePageAtMost) {
  std::mt19937 random(7);
  for (int trial = 0; trial < 100; ++trial) {
    const std::size_t place = 12 * kPage + random() % (bytes_.size() - 12 * kPage);
    std::vector<std::uint8_t> mutant = bytes_;
    mutant[place] ^= static_cast<std::uint8_t>(1u << (random() % 8));
    const ReadLog log = ReadMutant(mutant);

    EXPECT_GE(log.found.size() + kMostPerPage, 710u) << "bit at " << place;
    EXPECT_LE(log.num_wrong, 1u) << "bit at " << place;
  }
}

// Any of a row's lengths may be damaged: a text that no longer fits may be followed by one that
// does.
TEST_P(DamagedDatabase, WithAnyByteOfATopicsRowKeepsTheOtherTopics) {
  std::vector<std::uint8_t> bytes(bytes_.begin(), bytes_.begin() + 12 * kPage);  // without messages
  // A row is its header's size, a serial type per column (0: its number is the id), and the values.
  const std::array<std::uint8_t, 5> types = {7, 0, 13 + 2 * 4, 13 + 2 * 19, 13 + 2 * 3};
  const auto row = std::search(bytes.begin(), bytes.end(), types.begin(), types.end());
  ASSERT_NE(row, bytes.end());
  for (auto damaged = row - 2; damaged < row + 8; ++damaged) {
    const std::uint8_t sound = *damaged;
    for (int value = 0; value < 256; ++value) {
      *damaged = static_cast<std::uint8_t>(value);
      file_.Write(bytes);
      const auto topics = SqlitePages(std::make_shared<const InputFile>(file_.path())).FindTopics();

      const auto is_sound = [](const auto& topic) { return topic.second.encoding == "cdr"; };
      EXPECT_GE(std::count_if(topics.begin(), topics.end(), is_sound), 3)
          << "value " << value << " at byte " << damaged - row;
    }
    *damaged = sound;
  }
}

INSTANTIATE_TEST_SUITE_P(Layouts, DamagedDatabase, testing::Values("", "index=no"),
                         [](const auto& info) {
                           return *info.param == '\0' ? "WithIndex" : "NoIndex";
                         });

}  // namespace
}  // namespace parkade
