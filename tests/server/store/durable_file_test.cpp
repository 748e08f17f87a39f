#include "server/store/durable_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <random>
#include <thread>

#include "core/error.h"
#include "core/file.h"
#include "core/sha256.h"
#include "tests/server/store/temporary_store.h"

namespace parkade {
namespace {

TEST(GrowingFile, KeepsEveryByteWhateverTheSizeOfThePieces) {
  const TemporaryRoot root;
  std::mt19937 random(3);
  std::string content;
  for (int i = 0; i < 3'000'000; ++i) content += static_cast<char>(random());
  GrowingFile file(root.path() / "growing", static_cast<std::int64_t>(content.size()));
  for (size_t at = 0; at < content.size();) {
    const size_t size = std::min<size_t>(random() % 70'000, content.size() - at);
    file.Append(std::string_view(content).substr(at, size));
    at += size;
  }

  const std::string sha256 = file.Finish();
  file.MoveTo(root.path() / "a" / "b" / "kept");

  EXPECT_EQ(sha256, Sha256Of(content));
  EXPECT_EQ(file.size(), 3'000'000);
  EXPECT_EQ(ReadFile(root.path() / "a" / "b" / "kept"), content);
  EXPECT_EQ(ContentOf(root.path()), (std::set<std::string>{"a/", "a/b/", "a/b/kept"}));
}

TEST(GrowingFile, IsGoneUnlessItWasKept) {
  const TemporaryRoot root;
  {
    GrowingFile file(root.path() / "growing", 100);
    file.Append("half of it");
    file.Finish();
    EXPECT_EQ(ContentOf(root.path()).size(), 1u);
  }
  EXPECT_TRUE(ContentOf(root.path()).empty());
}

TEST(GrowingFile, RefusesMoreThanTheDiskHoldsAndLeavesItsRoomToOthers) {
  const TemporaryRoot root;
  const std::int64_t free_bytes = FreeBytes(root.path());
  std::atomic<bool> is_over = false;
  std::int64_t least_free = free_bytes;
  std::thread watch([&] {
    while (!is_over) least_free = std::min(least_free, FreeBytes(root.path()));
  });
  for (int i = 0; i < 100; ++i) {
    try {
      GrowingFile file(root.path() / "growing", free_bytes * 4);
      ADD_FAILURE() << "room for more than there is";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kDiskFull);
    }
  }
  is_over = true;
  watch.join();

  EXPECT_TRUE(ContentOf(root.path()).empty());
  EXPECT_GT(least_free, free_bytes / 2);
}

TEST(DataDirectory, BelongsToOneServiceAtATime) {
  const TemporaryRoot root;
  auto first = std::make_unique<DataDirectory>(root.path() / "data");
  try {
    DataDirectory second(root.path() / "data");
    FAIL() << "two services share a data directory";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kConflict);
  }
  first.reset();
  EXPECT_NO_THROW(DataDirectory(root.path() / "data"));
}

TEST(DataDirectory, ForgetsUnfinishedUploadsAndKeepsWhatItQuarantines) {
  const TemporaryRoot root;
  WriteText(root.path() / "data" / "tmp" / "0123", "half an upload");
  WriteText(root.path() / "data" / "maps" / "stray" / "map.glb", "whose?");

  const DataDirectory directory(root.path() / "data" / "");
  directory.PutAside(directory.MapsFolder() / "stray");

  EXPECT_TRUE(ContentOf(directory.root() / "tmp").empty());
  EXPECT_TRUE(ContentOf(directory.MapsFolder()).empty());
  EXPECT_EQ(ContentOf(directory.root() / "quarantine").size(), 2u);
}

}  // namespace
}  // namespace parkade
