#include "server/store/disk/ballast.h"

#include <gtest/gtest.h>

#include "tests/server/store/temporary_root.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

TEST(Ballast, HoldsRoomUntilItIsDropped) {
  const TemporaryRoot root;
  const fs::path file = root.path() / "ballast";
  Ballast ballast(file);
  ASSERT_TRUE(fs::exists(file)) << "this test needs 256 MiB of free disk";
  EXPECT_EQ(fs::file_size(file), 32u << 20);

  EXPECT_TRUE(ballast.Drop());
  EXPECT_FALSE(fs::exists(file));
  EXPECT_FALSE(ballast.Drop());

  ballast.Restore();
  EXPECT_TRUE(fs::exists(file));
}

}  // namespace
}  // namespace parkade
