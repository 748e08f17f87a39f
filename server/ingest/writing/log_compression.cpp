#include "server/ingest/writing/log_compression.h"

#include <bzlib.h>
#include <lz4frame.h>
#include <zstd.h>

#include "core/error.h"

namespace parkade {
namespace {

std::vector<std::uint8_t> CompressLz4(std::span<const std::uint8_t> bytes) {
  LZ4F_preferences_t preferences = LZ4F_INIT_PREFERENCES;
  preferences.frameInfo.contentChecksumFlag = LZ4F_contentChecksumEnabled;
  std::vector<std::uint8_t> packed(LZ4F_compressFrameBound(bytes.size(), &preferences));
  const std::size_t size =
      LZ4F_compressFrame(packed.data(), packed.size(), bytes.data(), bytes.size(), &preferences);
  Require(!LZ4F_isError(size), ErrorCode::kInternal, "lz4 cannot compress");
  packed.resize(size);
  return packed;
}

std::vector<std::uint8_t> CompressZstd(std::span<const std::uint8_t> bytes) {
  std::vector<std::uint8_t> packed(ZSTD_compressBound(bytes.size()));
  const std::size_t size =
      ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), /*level=*/1);
  Require(!ZSTD_isError(size), ErrorCode::kInternal, "zstd cannot compress");
  packed.resize(size);
  return packed;
}

std::vector<std::uint8_t> CompressBz2(std::span<const std::uint8_t> bytes) {
  auto size =
      static_cast<unsigned>(bytes.size() + bytes.size() / 100 + 600);  // as bzlib's manual demands
  std::vector<std::uint8_t> packed(size);
  // bzlib takes no const, and does not write there.
  auto* source = const_cast<char*>(reinterpret_cast<const char*>(bytes.data()));
  const int result = BZ2_bzBuffToBuffCompress(reinterpret_cast<char*>(packed.data()), &size, source,
                                              static_cast<unsigned>(bytes.size()), 9, 0, 0);
  Require(result == BZ_OK, ErrorCode::kInternal, "bzip2 cannot compress");
  packed.resize(size);
  return packed;
}

}  // namespace

const char* NameOf(LogCompression compression) {
  switch (compression) {
    case LogCompression::kNone: return "";
    case LogCompression::kLz4: return "lz4";
    case LogCompression::kZstd: return "zstd";
    case LogCompression::kBz2: return "bz2";
  }
  return "";
}

std::vector<std::uint8_t> Compress(std::span<const std::uint8_t> bytes,
                                   LogCompression compression) {
  switch (compression) {
    case LogCompression::kNone: break;
    case LogCompression::kLz4: return CompressLz4(bytes);
    case LogCompression::kZstd: return CompressZstd(bytes);
    case LogCompression::kBz2: return CompressBz2(bytes);
  }
  return {bytes.begin(), bytes.end()};
}

}  // namespace parkade
