#include "server/map_folder/input_hash.h"

#include <gtest/gtest.h>

#include "core/files/file.h"
#include "core/files/sha256.h"
#include "tests/server/store/temporary_store.h"

namespace parkade {
namespace {

TEST(InputHash, OfAFileIsThatOfItsContent) {
  TemporaryRoot root;
  WriteFileAtomically(root.path() / "a.bag", std::string_view("abc"));
  const InputHash hash = HashInput(root.path() / "a.bag");
  EXPECT_EQ(hash.name, "a.bag");
  EXPECT_EQ(hash.bytes, 3);
  EXPECT_EQ(hash.sha256, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(InputHash, OfAFolderIsThatOfAllItsFilesByName) {
  TemporaryRoot root;
  const auto folder = root.path() / "drive";
  std::filesystem::create_directories(folder / "mav0");
  WriteFileAtomically(folder / "mav0" / "b", std::string_view("bb"));
  WriteFileAtomically(folder / "a", std::string_view("a"));
  const InputHash hash = HashInput(folder / "");
  EXPECT_EQ(hash.name, "drive");
  EXPECT_EQ(hash.bytes, 3);
  EXPECT_EQ(hash.sha256, Sha256Of(Sha256Of("a") + " 1 a\n" + Sha256Of("bb") + " 2 mav0/b\n"));

  std::filesystem::rename(folder / "a", folder / "c");
  EXPECT_NE(HashInput(folder).sha256, hash.sha256);
}

TEST(InputHash, OfADatabaseCountsTheRowsInItsWriteAheadLog) {
  TemporaryRoot root;
  const auto file = root.path() / "a.db3";
  WriteText(file, "abc");
  WriteText(root.path() / "a.db3-wal", "");
  EXPECT_EQ(HashInput(file).sha256, Sha256Of("abc")) << "no row";

  const std::string rows(40, 'w');
  WriteText(root.path() / "a.db3-wal", rows);
  const InputHash hash = HashInput(file);
  EXPECT_EQ(hash.name, "a.db3");
  EXPECT_EQ(hash.bytes, 43);
  EXPECT_EQ(hash.sha256,
            Sha256Of(Sha256Of("abc") + " 3 a.db3\n" + Sha256Of(rows) + " 40 a.db3-wal\n"));
}

TEST(InputHash, OfAFolderDoesNotCountTheMapThatIsMadeInIt) {
  TemporaryRoot root;
  const auto folder = root.path() / "drive";
  WriteText(folder / "a", "a");
  const std::string sha256 = HashInput(folder).sha256;
  WriteText(folder / "map" / "map.glb", "made since");

  EXPECT_NE(HashInput(folder).sha256, sha256);
  EXPECT_EQ(HashInput(folder, folder / "map").sha256, sha256);
  EXPECT_EQ(HashInput(folder / "", folder / "map" / "").sha256, sha256);
}

}  // namespace
}  // namespace parkade
