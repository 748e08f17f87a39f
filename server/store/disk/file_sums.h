#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace parkade {

/// A file is checked whenever a piece of it is read: quick checksums stand beside its SHA-256.
constexpr std::int64_t kSummedBytes = std::int64_t{1} << 20;

struct FileSums {
  std::int64_t bytes = 0;
  std::string sha256;
  std::string pieces;  ///< XXH3 (64 bits) of each piece of kSummedBytes, 16 hexadecimal digits each
};

/// Reads the whole file once. Nothing where `go_on`, asked before each piece, says no. Throws
/// Error{kInternal} where the file cannot be read.
std::optional<FileSums> SumsOfFile(
    const std::filesystem::path& file, const std::function<bool()>& go_on = [] { return true; });

/// True when the file is as long as it should be and has these pieces. Reads it whole.
bool HasPieces(const std::filesystem::path& file, std::int64_t bytes, std::string_view pieces);

/// True when `content` is the piece number `index`, from 0, of a file with these sums.
bool IsPiece(std::string_view content, std::int64_t index, std::string_view pieces);

}  // namespace parkade
