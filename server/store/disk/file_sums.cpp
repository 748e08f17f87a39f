#include "server/store/disk/file_sums.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <array>
#include <fstream>
#include <vector>

#include "core/error.h"
#include "core/files/sha256.h"

namespace parkade {
namespace {

constexpr size_t kDigits = 16;

std::string SumOf(std::string_view content) {
  constexpr char kHex[] = "0123456789abcdef";
  XXH64_hash_t sum = XXH3_64bits(content.data(), content.size());
  std::string text(kDigits, '0');
  for (size_t i = kDigits; i-- > 0; sum >>= 4) text[i] = kHex[sum & 15];
  return text;
}

}  // namespace

std::optional<FileSums> SumsOfFile(const std::filesystem::path& file,
                                   const std::function<bool()>& go_on) {
  std::ifstream stream(file, std::ios::binary);
  std::vector<char> piece(kSummedBytes);
  FileSums sums;
  Sha256 hash;
  while (stream.read(piece.data(), kSummedBytes) || stream.gcount() > 0) {
    if (!go_on()) return std::nullopt;
    const std::string_view content(piece.data(), static_cast<size_t>(stream.gcount()));
    hash.Add(content);
    sums.pieces += SumOf(content);
    sums.bytes += stream.gcount();
  }
  Require(stream.eof(), ErrorCode::kInternal, "cannot read '" + file.filename().string() + "'");
  sums.sha256 = hash.Finish();
  return sums;
}

bool HasPieces(const std::filesystem::path& file, std::int64_t bytes, std::string_view pieces) {
  std::ifstream stream(file, std::ios::binary);
  std::vector<char> piece(kSummedBytes);
  std::int64_t count = 0, index = 0;
  while (stream.read(piece.data(), kSummedBytes) || stream.gcount() > 0) {
    if (!IsPiece({piece.data(), static_cast<size_t>(stream.gcount())}, index++, pieces))
      return false;
    count += stream.gcount();
  }
  return stream.eof() && count == bytes;
}

bool IsPiece(std::string_view content, std::int64_t index, std::string_view pieces) {
  const size_t at = static_cast<size_t>(index) * kDigits;
  return at + kDigits <= pieces.size() && pieces.substr(at, kDigits) == SumOf(content);
}

}  // namespace parkade
