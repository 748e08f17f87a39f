#include "server/surface_file.h"

#include <zstd.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "core/error.h"
#include "core/file.h"
#include "slam/binary_archive.h"

namespace parkade {
namespace {

constexpr std::string_view kMagic = "parkade surface";
constexpr std::uint32_t kVersion = 1;  // of the layout
constexpr size_t kMaxBytes = size_t{16} << 30;
constexpr int kCompressionLevel = 3;

/// Column by column, each value the difference from the one before: neighbours are alike, so that this packs well.
struct StoredSurface {
  double cell_size = 0;
  std::vector<std::int32_t> x_steps = {}, y_steps = {}, height_steps = {};  ///< heights [mm]
  std::vector<std::uint16_t> sigmas = {};                                   ///< [mm]
  std::vector<std::uint8_t> beliefs = {};                                   ///< [1/255]
};

template <typename A>
void Exchange(A& archive, StoredSurface& stored) {
  archive(stored.cell_size, stored.x_steps, stored.y_steps, stored.height_steps, stored.sigmas, stored.beliefs);
}

std::int32_t Millimetres(float metres) {
  return static_cast<std::int32_t>(std::lround(1000 * static_cast<double>(metres)));
}

StoredSurface Stored(const SurfaceMap& surface) {
  StoredSurface stored{.cell_size = surface.cell_size};
  std::int32_t x = 0, y = 0, height = 0;
  for (const SurfaceCell& cell : surface.cells) {
    stored.x_steps.push_back(cell.x - x);
    stored.y_steps.push_back(cell.y - y);
    stored.height_steps.push_back(Millimetres(cell.height) - height);
    x = cell.x, y = cell.y, height = Millimetres(cell.height);
    stored.sigmas.push_back(
        static_cast<std::uint16_t>(std::min<std::int32_t>(Millimetres(cell.height_sigma), UINT16_MAX)));
    stored.beliefs.push_back(static_cast<std::uint8_t>(std::lround(255 * static_cast<double>(cell.free_belief))));
  }
  return stored;
}

SurfaceMap Restored(const StoredSurface& stored) {
  const size_t count = stored.x_steps.size();
  Require(stored.cell_size > 0 && stored.y_steps.size() == count && stored.height_steps.size() == count &&
              stored.sigmas.size() == count && stored.beliefs.size() == count,
          ErrorCode::kInvalidInput, "its columns do not belong together");
  SurfaceMap surface{stored.cell_size, {}};
  surface.cells.reserve(count);
  std::int32_t x = 0, y = 0, height = 0;
  for (size_t i = 0; i < count; ++i) {
    x += stored.x_steps[i], y += stored.y_steps[i], height += stored.height_steps[i];
    surface.cells.push_back({.x = x,
                             .y = y,
                             .height = static_cast<float>(height) / 1000,
                             .height_sigma = static_cast<float>(stored.sigmas[i]) / 1000,
                             .free_belief = static_cast<float>(stored.beliefs[i]) / 255});
  }
  return surface;
}

std::string Compress(const std::string& bytes) {
  const std::unique_ptr<ZSTD_CCtx, size_t (*)(ZSTD_CCtx*)> context(ZSTD_createCCtx(), ZSTD_freeCCtx);
  Require(context != nullptr, ErrorCode::kInternal, "no memory for zstd");
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_compressionLevel, kCompressionLevel);
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_checksumFlag, 1);
  std::string packed(ZSTD_compressBound(bytes.size()), '\0');
  const size_t size = ZSTD_compress2(context.get(), packed.data(), packed.size(), bytes.data(), bytes.size());
  Require(ZSTD_isError(size) == 0, ErrorCode::kInternal, "zstd cannot compress the surface");
  packed.resize(size);
  return packed;
}

std::string Decompress(std::string_view packed) {
  const unsigned long long size = ZSTD_getFrameContentSize(packed.data(), packed.size());
  Require(size <= kMaxBytes, ErrorCode::kInvalidInput, "it does not say how long it is");  // errors are huge numbers
  std::string bytes(size, '\0');
  const size_t unpacked = ZSTD_decompress(bytes.data(), bytes.size(), packed.data(), packed.size());
  Require(ZSTD_isError(unpacked) == 0 && unpacked == size, ErrorCode::kInvalidInput, "it is damaged");
  return bytes;
}

SurfaceMap Parse(std::string_view bytes) {
  Require(bytes.starts_with(kMagic), ErrorCode::kInvalidInput, "it holds no surface");
  bytes.remove_prefix(kMagic.size());
  std::uint32_t version = 0;
  BinaryReader head(bytes);
  head(version);
  Require(version == kVersion, ErrorCode::kInvalidInput,
          "it is of version " + std::to_string(version) + ", this program reads " + std::to_string(kVersion));
  bytes.remove_prefix(sizeof version);
  const std::string content = Decompress(bytes);
  BinaryReader reader(content);
  StoredSurface stored;
  reader(stored);
  Require(reader.is_at_end(), ErrorCode::kInvalidInput, "it is longer than it says");
  return Restored(stored);
}

}  // namespace

void WriteSurface(const SurfaceMap& surface, const std::filesystem::path& file) {
  StoredSurface stored = Stored(surface);
  BinaryWriter content, head;
  content(stored);
  std::uint32_t version = kVersion;
  head(version);
  WriteFileAtomically(file, std::string(kMagic) + head.bytes() + Compress(content.bytes()));
}

SurfaceMap ReadSurface(const std::filesystem::path& file) {
  const std::string bytes = ReadFile(file, kMaxBytes);
  try {
    return Parse(bytes);
  } catch (const Error& error) {
    throw Error(error.code(), "'" + file.filename().string() + "' cannot be used: " + error.what());
  }
}

}  // namespace parkade
