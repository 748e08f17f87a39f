#include "server/map_folder/stage_cache.h"

#include <gtest/gtest.h>

#include <fstream>

#include "core/files/file.h"
#include "tests/server/store/temporary_store.h"

namespace parkade {
namespace {

class StageProductsTest : public ::testing::Test {
 protected:
  /// What Get gives, and whether it was computed.
  std::pair<std::string, bool> Get(const StageCache& products, const std::string& key) {
    bool is_computed = false;
    const std::string result = products.Get("drive/loops.bin", key, [&] {
      is_computed = true;
      return "of " + key;
    });
    return {result, is_computed};
  }

  const std::string first_key_ = KeyOf({"first"}), second_key_ = KeyOf({"second"});
  TemporaryRoot root_;
  const std::filesystem::path old_map_ = root_.path() / "old", new_map_ = root_.path() / "new";
};

TEST_F(StageProductsTest, AResultIsComputedOnceForItsKey) {
  const StageCache first({}, old_map_);
  EXPECT_EQ(Get(first, first_key_), std::pair("of " + first_key_, true));
  EXPECT_EQ(Get(first, second_key_), std::pair("of " + second_key_, true));

  const StageCache second(old_map_, new_map_);
  EXPECT_EQ(Get(second, second_key_), std::pair("of " + second_key_, false));
  EXPECT_EQ(Get(second, KeyOf({"third"})).second, true);
  EXPECT_EQ(Get(StageCache(new_map_, {}), second_key_).second, false)
      << "kept for the build after next, too";
  EXPECT_EQ(Get(StageCache(new_map_, {}), first_key_).second, true)
      << "no longer asked for: not kept";
}

TEST_F(StageProductsTest, PieceByPieceTheSameIsKept) {
  const std::string file = "drive/places.bin", long_result(3'000'000, 'x');
  const auto compute = [&](const PieceSink& sink) {
    sink("of ");
    sink(first_key_);
    sink("");
    sink(long_result);
  };
  const auto never = [](const PieceSink&) { FAIL() << "it is there already"; };
  const StageCache whole({}, old_map_ / "whole"), pieces({}, old_map_);
  whole.Get(file, first_key_, [&] { return "of " + first_key_ + long_result; });
  pieces.Keep(file, first_key_, compute);
  EXPECT_TRUE(ReadFile(old_map_ / file) == ReadFile(old_map_ / "whole" / file));

  StageCache(old_map_, new_map_).Keep(file, first_key_, never);
  EXPECT_EQ(std::filesystem::hard_link_count(new_map_ / file), 2U);
  pieces.Keep(file, second_key_, compute);  // one of two
  StageCache(old_map_, root_.path() / "newer").Keep(file, first_key_, never);
  EXPECT_TRUE(ReadFile(root_.path() / "newer" / file) == ReadFile(old_map_ / "whole" / file));

  std::string damaged = ReadFile(new_map_ / file);
  damaged[1'000'000] ^= 1;
  std::filesystem::remove(new_map_ / file);
  std::ofstream(new_map_ / file, std::ios::binary) << damaged;
  StageCache(new_map_, root_.path() / "newest").Keep(file, first_key_, compute);
  EXPECT_TRUE(ReadFile(root_.path() / "newest" / file) == ReadFile(old_map_ / "whole" / file));
}

TEST_F(StageProductsTest, WhatIsSharedUnreadIsFoundAndWhereDamagedComputedAgain) {
  const std::string file = "drive/places.bin";
  const auto compute = [&] { return "of " + first_key_; };
  const auto never = []() -> std::string { throw std::logic_error("it is there already"); };
  StageCache({}, old_map_).Get(file, first_key_, compute);
  const StageCache cache(old_map_, new_map_);
  EXPECT_FALSE(cache.ShareUnread(file, second_key_));
  EXPECT_FALSE(std::filesystem::exists(new_map_ / file));
  ASSERT_TRUE(cache.ShareUnread(file, first_key_));
  EXPECT_EQ(cache.ReadShared(file, first_key_, never), compute());
  EXPECT_EQ(std::filesystem::hard_link_count(new_map_ / file), 2U);

  std::string damaged = ReadFile(old_map_ / file);
  damaged.back() ^= 1;
  std::filesystem::remove_all(new_map_);
  std::filesystem::remove(old_map_ / file);
  std::ofstream(old_map_ / file, std::ios::binary) << damaged;
  ASSERT_TRUE(cache.ShareUnread(file, first_key_)) << "nobody looked";
  EXPECT_EQ(cache.ReadShared(file, first_key_, compute), compute());
  EXPECT_EQ(StageCache(new_map_, {}).Get(file, first_key_, never), compute());

  std::filesystem::resize_file(old_map_ / file, damaged.size() - 1);
  EXPECT_FALSE(StageCache(old_map_, root_.path() / "newer").ShareUnread(file, first_key_))
      << "cut off";
}

TEST_F(StageProductsTest, WhatIsSharedDamagedIsTakenFromAnEarlierTry) {
  const std::string file = "drive/places.bin";
  const std::filesystem::path work = root_.path() / "work";
  const auto compute = [&] { return "of " + first_key_; };
  const auto never = []() -> std::string { throw std::logic_error("it is there already"); };
  StageCache({}, old_map_).Get(file, first_key_, compute);
  StageCache({}, work).Get(file, first_key_, compute);
  std::string damaged = ReadFile(old_map_ / file);
  damaged.back() ^= 1;
  std::ofstream(old_map_ / file, std::ios::binary) << damaged;

  const StageCache cache(old_map_, new_map_, work);
  ASSERT_TRUE(cache.ShareUnread(file, first_key_));
  EXPECT_EQ(cache.ReadShared(file, first_key_, never), compute());
  EXPECT_EQ(StageCache(new_map_, {}).Get(file, first_key_, never), compute());
}

TEST_F(StageProductsTest, ABuildThatWasEndedLeavesItsResultsToTheNext) {
  const std::filesystem::path work = root_.path() / "work", next = root_.path() / "next";
  const std::string places = "drive/places.bin";
  const auto compute = [](const PieceSink& sink) { sink("places"); };
  const auto never = [](const PieceSink&) { FAIL() << "it is there already"; };
  {
    const StageCache ended({}, new_map_, work);
    EXPECT_TRUE(Get(ended, first_key_).second);
    EXPECT_TRUE(Get(ended, second_key_).second);
    ended.Keep(places, first_key_, compute);
  }
  std::filesystem::remove_all(new_map_);

  const StageCache again({}, next, work);
  EXPECT_FALSE(Get(again, first_key_).second);
  EXPECT_EQ(Get(again, second_key_), std::pair("of " + second_key_, false));
  again.Keep(places, first_key_, never);
  EXPECT_TRUE(Get(again, KeyOf({"third"})).second);
  EXPECT_FALSE(Get(StageCache(next, {}), second_key_).second) << "the new map has all of its own";
  EXPECT_FALSE(Get(StageCache({}, {}, work), first_key_).second) << "what was kept is kept";
}

TEST_F(StageProductsTest, WhatIsTakenFromTheMapIsNotKeptTwice) {
  const std::filesystem::path work = root_.path() / "work";
  Get(StageCache({}, old_map_), first_key_);
  EXPECT_FALSE(Get(StageCache(old_map_, new_map_, work), first_key_).second);
  EXPECT_FALSE(std::filesystem::exists(work));
}

TEST_F(StageProductsTest, ALinkReplacesItsOwnFileAndOthers) {
  WriteText(root_.path() / "a", "one");
  WriteText(root_.path() / "b", "two");
  LinkOrCopy(root_.path() / "a", root_.path() / "b");
  LinkOrCopy(root_.path() / "a", root_.path() / "b");
  EXPECT_EQ(ReadFile(root_.path() / "b"), "one");
  EXPECT_EQ(ContentOf(root_.path()), (std::set<std::string>{"a", "b"}));
}

TEST_F(StageProductsTest, TheLastResultOfTheMapIsGivenWithItsKey) {
  const StageCache first({}, old_map_), second(old_map_, new_map_);
  EXPECT_EQ(second.LastOfMap("heights.bin"), std::nullopt);
  first.Get("heights.bin", first_key_, [] { return "one"; });
  first.Get("heights.bin", second_key_, [] { return "two"; });
  EXPECT_EQ(second.LastOfMap("heights.bin"), std::pair(second_key_, std::string("two")));
  EXPECT_EQ(first.LastOfMap("heights.bin"), std::nullopt) << "it starts from no map";
}

TEST_F(StageProductsTest, AFinishedMapGivesWhatItHolds) {
  const std::filesystem::path file = old_map_ / "drive/loops.bin";
  EXPECT_FALSE(LastProduct(file));
  const StageCache products({}, old_map_);
  Get(products, first_key_);
  EXPECT_EQ(LastProduct(file), "of " + first_key_);
  Get(products, second_key_);
  EXPECT_EQ(LastProduct(file), "of " + second_key_);

  std::filesystem::resize_file(file, std::filesystem::file_size(file) - 1);
  EXPECT_FALSE(LastProduct(file)) << "cut off";
}

TEST_F(StageProductsTest, WhatIsDamagedOrCutOffIsComputedAgain) {
  Get(StageCache({}, old_map_), first_key_);
  const std::filesystem::path file = old_map_ / "drive/loops.bin";
  const std::string whole = ReadFile(file, 1 << 20);
  for (const size_t length : {size_t{3}, size_t{40}, size_t{150}, whole.size() - 1}) {
    std::ofstream(file, std::ios::binary) << whole.substr(0, length);
    EXPECT_EQ(Get(StageCache(old_map_, {}), first_key_), std::pair("of " + first_key_, true))
        << length;
  }
  std::string damaged = whole;
  damaged.back() ^= 1;
  std::ofstream(file, std::ios::binary) << damaged;
  EXPECT_TRUE(Get(StageCache(old_map_, {}), first_key_).second);
  std::ofstream(file, std::ios::binary) << whole;
  EXPECT_FALSE(Get(StageCache(old_map_, {}), first_key_).second);
}

TEST_F(StageProductsTest, AFileOfOneResultIsSharedUntilItGrows) {
  Get(StageCache({}, old_map_), first_key_);
  const std::filesystem::path old_file = old_map_ / "drive/loops.bin",
                              new_file = new_map_ / "drive/loops.bin";
  const std::string before = ReadFile(old_file, 1 << 20);
  std::filesystem::permissions(old_file,
                               std::filesystem::perms::owner_read);  // as of a published map

  const StageCache second(old_map_, new_map_);
  Get(second, first_key_);
  EXPECT_TRUE(std::filesystem::equivalent(old_file, new_file));
  Get(second, second_key_);

  EXPECT_EQ(ReadFile(old_file, 1 << 20), before) << "a published map does not change";
  EXPECT_NE(std::filesystem::status(new_file).permissions() & std::filesystem::perms::owner_write,
            std::filesystem::perms::none)
      << "only root may write without";
  EXPECT_FALSE(Get(StageCache(new_map_, {}), first_key_).second);
  EXPECT_FALSE(Get(StageCache(new_map_, {}), second_key_).second);
}

TEST(KeyOf, TellsPartsApart) {
  EXPECT_NE(KeyOf({"ab", "c"}), KeyOf({"a", "bc"}));
  EXPECT_NE(KeyOf({"a", "b"}), KeyOf({"b", "a"}));
  EXPECT_EQ(KeyOf({"a", "b"}), KeyOf({"a", "b"}));
}

}  // namespace
}  // namespace parkade
