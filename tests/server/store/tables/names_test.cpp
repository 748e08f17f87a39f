#include "server/store/tables/names.h"

#include <gtest/gtest.h>

#include <set>

namespace parkade {
namespace {

TEST(NewId, IsSixteenHexadecimalDigitsAndNeverTheSame) {
  std::set<std::string> ids;
  for (int i = 0; i < 1000; ++i) {
    const std::string id = NewId();
    EXPECT_EQ(id.size(), 16u);
    EXPECT_EQ(id.find_first_not_of("0123456789abcdef"), std::string::npos);
    ids.insert(id);
  }
  EXPECT_EQ(ids.size(), 1000u);
}

TEST(NowUtc, LooksLikeRfc3339) {
  const std::string now = NowUtc();
  EXPECT_EQ(now.size(), 24u);
  EXPECT_EQ(now[10], 'T');
  EXPECT_EQ(now.back(), 'Z');
}

TEST(PlainName, RefusesWhatCouldBeAPathOrAnOption) {
  EXPECT_TRUE(IsPlainName("garage-2.north_wing"));
  for (const char* name :
       {"", ".", "..", ".hidden", "-rf", "a/b", "a b", "a\nb", "\xc3\xa4", "a%2fb", "a\\b"})
    EXPECT_FALSE(IsPlainName(name)) << name;
  EXPECT_TRUE(IsPlainName(std::string(64, 'a')));
  EXPECT_FALSE(IsPlainName(std::string(65, 'a')));
}

TEST(PlainNameFromFilename, KeepsWhatPeopleRecognize) {
  EXPECT_EQ(PlainNameFromFilename("lot.mcap"), "lot");
  EXPECT_EQ(PlainNameFromFilename("tiles.mcap"), "drivetiles")
      << "a map has a folder tiles/ itself";
  EXPECT_EQ(PlainNameFromFilename("MH_01_easy.tar.gz"), "MH_01_easy");
  EXPECT_EQ(PlainNameFromFilename("2026-11-21 drive (3).bag"), "2026-11-21-drive--3-");
  EXPECT_EQ(PlainNameFromFilename("lot.v2.bag"), "lot-v2");
}

TEST(PlainNameFromFilename, IsPlainWhateverItIsGiven) {
  for (const char* name :
       {"", "../../etc/passwd", "C:\\drives\\x.bag", "....", "\xff\xfe", "-rf", ".bag", "a\0b"})
    EXPECT_TRUE(IsPlainName(PlainNameFromFilename(name))) << name;
  EXPECT_EQ(PlainNameFromFilename("../../etc/passwd"), "passwd");
  EXPECT_LE(PlainNameFromFilename(std::string(5000, 'x')).size(), 48u);
}

TEST(PlainPath, AllowsFoldersButNoWayOut) {
  EXPECT_TRUE(IsPlainPath("map.glb"));
  EXPECT_TRUE(IsPlainPath("tiles/0/1/2.glb"));
  for (const char* path : {"", "/map.glb", "a//b", "../map.glb", "a/../b", "a/", "a/b/c/d/e"})
    EXPECT_FALSE(IsPlainPath(path)) << path;
}

}  // namespace
}  // namespace parkade
