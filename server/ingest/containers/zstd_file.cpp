#include "server/ingest/containers/zstd_file.h"

#include <fstream>

#include "core/error.h"
#include "server/ingest/containers/chunk_codec.h"
#include "server/ingest/containers/damage.h"

namespace parkade {
UnpackedFile UnpackZstdFile(const InputFile& packed, const std::filesystem::path& folder,
                            const std::function<bool(std::string_view)>& accepts) {
  constexpr std::size_t kPiece = std::size_t{1} << 20;
  constexpr std::size_t kShown = 16;
  UnpackedFile unpacked;
  UnpackingStream stream(packed, 0, packed.size(), ChunkCompression::kZstd);
  std::vector<std::uint8_t> piece(kPiece);
  std::size_t size = stream.Read(std::span(piece).first(kShown));
  if (!accepts({reinterpret_cast<const char*>(piece.data()), size})) return unpacked;
  unpacked.file = std::make_shared<const TemporaryFile>(folder);
  std::ofstream out(unpacked.file->path(), std::ios::binary);
  while (size > 0) {
    out.write(reinterpret_cast<const char*>(piece.data()), static_cast<std::streamsize>(size));
    Require(out.good(), ErrorCode::kDiskFull,
            "there is no space to unpack '" + packed.name() + "'");
    size = stream.Read(piece);
  }
  out.close();
  Require(out.good(), ErrorCode::kDiskFull, "there is no space to unpack '" + packed.name() + "'");
  if (stream.state() == UnpackingStream::State::kEnded) return unpacked;
  const bool is_cut = stream.state() == UnpackingStream::State::kCut;
  unpacked.damage.is_truncated = is_cut;
  AddLoss(unpacked.damage,
          {is_cut ? "the zstd file is cut off" : "the zstd file is damaged", "", {}, 0});
  return unpacked;
}

}  // namespace parkade
