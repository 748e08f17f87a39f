#include "server/jobs/pictures/picture_cache.h"

#include <fstream>

#include "tests/server/store/temporary_root.h"

namespace parkade {
namespace {

class PictureCacheTest : public testing::Test {
 protected:
  PictureCache Open(PictureCacheLimits limits = {}) const {
    return {root_.path(), limits, [](const std::string& drive) { return drive != "gone"; }};
  }
  void Put(PictureCache& cache, const std::string& name, size_t bytes) const {
    Write(name, bytes);
    cache.Add(name);
  }
  void Write(const std::string& name, size_t bytes) const {
    std::filesystem::create_directories((root_.path() / name).parent_path());
    std::ofstream(root_.path() / name) << std::string(bytes, 'x');
  }

  TemporaryRoot root_;
};

TEST_F(PictureCacheTest, DeletesWhatNobodyAskedForTheLongest) {
  PictureCache cache = Open({.bytes = 300, .files = 100});
  for (const char* name : {"d/r/1", "d/r/2", "d/r/3"}) Put(cache, name, 100);
  EXPECT_TRUE(cache.Find("d/r/1"));

  Put(cache, "d/r/4", 100);

  EXPECT_FALSE(cache.Find("d/r/2"));
  EXPECT_FALSE(std::filesystem::exists(cache.PathOf("d/r/2")));
  for (const char* name : {"d/r/1", "d/r/3", "d/r/4"})
    EXPECT_TRUE(std::filesystem::exists(cache.PathOf(name))) << name;
  EXPECT_EQ(cache.bytes(), 300);
}

TEST_F(PictureCacheTest, HoldsNoMoreFilesThanItMay) {
  PictureCache cache = Open({.bytes = 1000, .files = 2});
  for (int i = 0; i < 10; ++i) Put(cache, "d/r/" + std::to_string(i), 1);

  EXPECT_EQ(cache.files(), 2);
  EXPECT_FALSE(cache.Find("d/r/7"));
  EXPECT_TRUE(cache.Find("d/r/8"));
}

TEST_F(PictureCacheTest, AFileThatIsLargerThanAllStaysAlone) {
  PictureCache cache = Open({.bytes = 10, .files = 10});
  Put(cache, "d/r/small", 5);
  Put(cache, "d/r/large", 50);

  EXPECT_FALSE(cache.Find("d/r/small"));
  EXPECT_EQ(cache.Find("d/r/large").value_or("").size(), 50u);
}

TEST_F(PictureCacheTest, TakesOverWhatIsThereInTheOrderOfItsUse) {
  for (const char* name : {"d/r/a", "d/r/b", "d/r/c"}) Write(name, 100);
  const auto now = std::filesystem::file_time_type::clock::now();
  std::filesystem::last_write_time(root_.path() / "d/r/a", now);
  std::filesystem::last_write_time(root_.path() / "d/r/b", now - std::chrono::hours(2));
  std::filesystem::last_write_time(root_.path() / "d/r/c", now - std::chrono::hours(1));

  PictureCache cache = Open({.bytes = 200, .files = 10});

  EXPECT_TRUE(cache.Find("d/r/a"));
  EXPECT_FALSE(cache.Find("d/r/b"));
  EXPECT_TRUE(cache.Find("d/r/c"));
}

TEST_F(PictureCacheTest, ForgetsDrivesThatAreGone) {
  Write("gone/r/a", 10);
  Write("d/r/a", 10);

  const PictureCache cache = Open();

  EXPECT_FALSE(std::filesystem::exists(root_.path() / "gone"));
  EXPECT_EQ(cache.files(), 1);
}

TEST_F(PictureCacheTest, AFileThatOthersDeletedIsNotThere) {
  PictureCache cache = Open();
  Put(cache, "d/r/a", 10);
  std::filesystem::remove_all(root_.path() / "d");

  EXPECT_FALSE(cache.Find("d/r/a"));
  EXPECT_EQ(cache.bytes(), 0);
  cache.Add("d/r/never-there");
  EXPECT_EQ(cache.files(), 0);
}

}  // namespace
}  // namespace parkade
