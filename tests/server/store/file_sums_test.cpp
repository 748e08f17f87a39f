#include "server/store/disk/file_sums.h"

#include "core/files/file.h"
#include "core/files/sha256.h"
#include "tests/server/store/temporary_store.h"

namespace parkade {
namespace {

TEST(FileSums, NameEveryPiece) {
  const TemporaryRoot root;
  std::string content(2 * kSummedBytes + 5, 'x');
  content[kSummedBytes] = 'y';
  WriteText(root.path() / "file", content);

  const FileSums sums = *SumsOfFile(root.path() / "file");

  EXPECT_EQ(sums.bytes, static_cast<std::int64_t>(content.size()));
  EXPECT_EQ(sums.sha256, Sha256Of(content));
  EXPECT_EQ(sums.pieces.size(), 3u * 16);
  for (const std::int64_t i : {0, 1, 2}) {
    std::string piece = content.substr(static_cast<size_t>(i * kSummedBytes), kSummedBytes);
    EXPECT_TRUE(IsPiece(piece, i, sums.pieces)) << i;
    EXPECT_FALSE(IsPiece(piece, i + 1, sums.pieces)) << i;
    piece.back() = static_cast<char>(piece.back() ^ 1);
    EXPECT_FALSE(IsPiece(piece, i, sums.pieces)) << i;
  }
}

TEST(FileSums, AnEmptyFileHasNoPieces) {
  const TemporaryRoot root;
  WriteText(root.path() / "file", "");
  const FileSums sums = *SumsOfFile(root.path() / "file");
  EXPECT_EQ(sums.sha256, Sha256Of(""));
  EXPECT_TRUE(sums.pieces.empty());
}

TEST(FileSums, NobodyWaitsForThoseThatNobodyWants) {
  const TemporaryRoot root;
  WriteText(root.path() / "file", std::string(5 * kSummedBytes, 'x'));
  int pieces = 0;
  EXPECT_FALSE(SumsOfFile(root.path() / "file", [&] { return ++pieces < 3; }).has_value());
  EXPECT_EQ(pieces, 3);
}

}  // namespace
}  // namespace parkade
