#include "server/store/disk/durable_file.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/files/file.h"
#include "tests/server/store/temporary_store.h"

namespace parkade {
namespace {

TEST(KeepFile, TakesThePlaceOfWhatIsThere) {
  const TemporaryRoot root;
  WriteText(root.path() / "new", "as it was sent");
  WriteText(root.path() / "a" / "b" / "kept", "rotten");

  for (int twice = 0; twice < 2; ++twice) {
    KeepFile(root.path() / "new", root.path() / "a" / "b" / "kept");

    EXPECT_EQ(ReadFile(root.path() / "a" / "b" / "kept"), "as it was sent");
    EXPECT_EQ(ContentOf(root.path()), (std::set<std::string>{"a/", "a/b/", "a/b/kept", "new"}));
  }
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
