#include "server/store/quarantine.h"

#include "tests/server/store/temporary_store.h"

namespace parkade {
namespace {

class QuarantineTest : public testing::Test {
 protected:
  QuarantineTest() {
    std::filesystem::create_directories(folder_);
    WriteText(root_.path() / "maps" / "stray" / "a.bin", std::string(1000, 'x'));
    WriteText(root_.path() / "maps" / "stray" / "b.bin", std::string(24, 'x'));
    quarantine_.Take(root_.path() / "maps" / "stray", root_.path());
  }

  TemporaryRoot root_;
  const std::filesystem::path folder_ = root_.path() / "quarantine";
  Quarantine quarantine_{folder_};
};

TEST_F(QuarantineTest, CountsWhatIsPutThereAndWhatIsFound) {
  EXPECT_EQ(quarantine_.num_entries(), 1);
  EXPECT_EQ(quarantine_.num_bytes(), 1024);

  Quarantine next(folder_);
  next.Tidy();
  EXPECT_EQ(next.num_entries(), 1);
  EXPECT_EQ(next.num_bytes(), 1024);
}

TEST_F(QuarantineTest, KeepsWhatIsNewHoweverOldItsFilesAre) {
  using std::filesystem::last_write_time;
  const std::filesystem::path entry = std::filesystem::directory_iterator(folder_)->path();
  last_write_time(entry, last_write_time(entry) - std::chrono::hours(24 * 365));
  quarantine_.Tidy();
  EXPECT_EQ(quarantine_.num_entries(), 1);
}

TEST_F(QuarantineTest, RemovesWhatIsOld) {
  quarantine_.Tidy(std::chrono::seconds(-2));  // as if it had been there longer
  EXPECT_EQ(quarantine_.num_entries(), 0);
  EXPECT_EQ(quarantine_.num_bytes(), 0);
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

}  // namespace
}  // namespace parkade
