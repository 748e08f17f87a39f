#include "server/store/disk/growing_file.h"

#include <algorithm>
#include <atomic>
#include <random>
#include <thread>

#include "core/files/file.h"
#include "server/store/disk/durable_file.h"
#include "tests/server/store/temporary_store.h"

namespace parkade {
namespace {

TEST(GrowingFile, KeepsEveryByteWhateverTheSizeOfThePieces) {
  const TemporaryRoot root;
  std::mt19937 random(3);
  std::string content;
  for (int i = 0; i < 3'000'000; ++i) content += static_cast<char>(random());
  const std::filesystem::path path = root.path() / "growing";
  GrowingFile file = GrowingFile::Create(path, static_cast<std::int64_t>(content.size()));
  for (size_t at = 0; at < content.size();) {
    const size_t size = std::min<size_t>(random() % 70'000, content.size() - at);
    file.Append(std::string_view(content).substr(at, size));
    at += size;
  }

  file.Finish();

  EXPECT_EQ(file.size(), 3'000'000);
  EXPECT_EQ(ReadFile(path), content);
}

TEST(GrowingFile, GoesOnWhereItIsTold) {
  const TemporaryRoot root;
  const std::filesystem::path path = root.path() / "growing";
  {
    GrowingFile file = GrowingFile::Create(path, 100);
    file.Append("durable, not durable");
    file.Sync();
  }
  GrowingFile file = GrowingFile::Continue(path, 7);
  file.Append(" again");
  file.Finish();

  EXPECT_EQ(ReadFile(path), "durable again");
  EXPECT_THROW(GrowingFile::Continue(path, 1000), Error) << "the disk lost some of it";
}

TEST(GrowingFile, LeavesZerosWhereItSkipsAndTheRestWhereItWritesOver) {
  const TemporaryRoot root;
  const std::filesystem::path path = root.path() / "growing";
  {
    GrowingFile file = GrowingFile::Create(path, 20);
    file.Append("head");
    file.Skip(3);
    file.Append("tail");
    file.Skip(2);
    file.Finish();
    EXPECT_EQ(file.size(), 13);
  }
  EXPECT_EQ(ReadFile(path), std::string("head\0\0\0tail\0\0", 13));

  GrowingFile file = GrowingFile::WriteOver(path, 4);
  file.Append("-x-");
  file.Sync();

  EXPECT_EQ(file.size(), 7);
  EXPECT_EQ(ReadFile(path), std::string("head-x-tail\0\0", 13));
  EXPECT_THROW(GrowingFile::WriteOver(path, 1000), Error) << "the disk lost some of it";
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
      GrowingFile::Create(root.path() / "growing", free_bytes * 4);
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

}  // namespace
}  // namespace parkade
