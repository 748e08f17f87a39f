#include "server/pipeline/keyed.h"

#include <gtest/gtest.h>

namespace parkade {
namespace {

struct Product {
  int number = 0;
  double seconds = 0;
};

class CachedTest : public testing::Test {
 protected:
  CachedTest() { std::filesystem::remove_all(root_); }
  ~CachedTest() override { std::filesystem::remove_all(root_); }

  /// Of a stage that makes `number` in two seconds, from map `from` to map `to`.
  Keyed<Product> Run(const std::string& from, const std::string& to, const std::string& key,
                     int number) {
    const StageCache cache(from.empty() ? "" : root_ / from, root_ / to);
    const StageFile<Product> file{
        "drive/stage.bin", [](const Product& product) { return std::to_string(product.number); },
        [](std::string_view bytes) { return Product{std::stoi(std::string(bytes))}; }};
    return Cached(cache, file, key, [&] {
      ++num_computed_;
      return Product{number, 2};
    });
  }

  const std::filesystem::path root_ = std::filesystem::path(testing::TempDir()) / "keyed_test";
  int num_computed_ = 0;
};

const std::string kKey(64, 'a'), kOtherKey(64, 'b');

TEST_F(CachedTest, WhatWasComputedTookItsTimeAndCarriesItsKey) {
  const Keyed<Product> made = Run("", "first", kKey, 7);

  EXPECT_EQ(made.value.number, 7);
  EXPECT_EQ(made.value.seconds, 2);
  EXPECT_EQ(made.key, kKey);
}

TEST_F(CachedTest, TheSameKeyIsTakenAndTookNoTime) {
  Run("", "first", kKey, 7);
  const Keyed<Product> taken = Run("first", "second", kKey, 8);

  EXPECT_EQ(num_computed_, 1);
  EXPECT_EQ(taken.value.number, 7);
  EXPECT_EQ(taken.value.seconds, 0);
  EXPECT_TRUE(std::filesystem::exists(root_ / "second/drive/stage.bin"));
}

TEST_F(CachedTest, AnotherKeyIsComputedAnew) {
  Run("", "first", kKey, 7);
  const Keyed<Product> made = Run("first", "second", kOtherKey, 8);

  EXPECT_EQ(num_computed_, 2);
  EXPECT_EQ(made.value.number, 8);
}

}  // namespace
}  // namespace parkade
