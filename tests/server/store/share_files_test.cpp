#include "server/store/disk/share_files.h"

#include "core/files/file.h"
#include "tests/server/store/temporary_store.h"

namespace parkade {
namespace {

const std::string kLong(100'000, 'x');

class SharedFiles : public testing::Test {
 protected:
  SharedFiles() {
    for (const std::filesystem::path& folder : {older_, newer_}) {
      WriteText(folder / "a" / "ground.bin", kLong);
      WriteText(folder / "small.json", "{}");
    }
  }
  bool IsShared(const std::string& name) {
    return std::filesystem::equivalent(older_ / name, newer_ / name);
  }

  TemporaryRoot root_;
  const std::filesystem::path older_ = root_.path() / "older", newer_ = root_.path() / "newer";
};

TEST_F(SharedFiles, AreThoseOfTheSameNameAndContent) {
  WriteText(older_ / "b" / "ground.bin", kLong);
  WriteText(newer_ / "c" / "ground.bin", kLong);
  std::filesystem::permissions(older_ / "a" / "ground.bin", std::filesystem::perms::owner_read);
  ShareFilesWith(older_, newer_);
  ShareFilesWith(older_, newer_);

  EXPECT_TRUE(IsShared("a/ground.bin"));
  EXPECT_FALSE(IsShared("small.json"));
  EXPECT_EQ(ReadFile(newer_ / "a" / "ground.bin"), kLong);
  EXPECT_EQ(ContentOf(newer_),
            (std::set<std::string>{"a/", "a/ground.bin", "c/", "c/ground.bin", "small.json"}));
}

TEST_F(SharedFiles, AreNotThoseThatHaveRotted) {
  std::string rotten = kLong;
  rotten[50'000] = 'y';
  WriteText(older_ / "a" / "ground.bin", rotten);
  ShareFilesWith(older_, newer_);

  EXPECT_FALSE(IsShared("a/ground.bin"));
  EXPECT_EQ(ReadFile(newer_ / "a" / "ground.bin"), kLong);
}

TEST_F(SharedFiles, NeedNoOlderFolder) {
  ShareFilesWith(root_.path() / "nothing", newer_);
  EXPECT_EQ(ReadFile(newer_ / "a" / "ground.bin"), kLong);
}

}  // namespace
}  // namespace parkade
