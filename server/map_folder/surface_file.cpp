#include "server/map_folder/surface_file.h"

#include <zstd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <memory>
#include <utility>

#include "core/error.h"
#include "core/files/binary_archive.h"
#include "core/files/file.h"
#include "core/files/for_each_releasing.h"

namespace parkade {
namespace {

constexpr std::string_view kMagic = "parkade surface";
constexpr std::uint32_t kLayoutVersion = 1;
constexpr size_t kMaxBytes = size_t{16} << 30;
constexpr int kCompressionLevel = 3;

/// Column by column, each value the difference from the one before: neighbors are alike, so that
/// this packs well.
struct StoredSurface {
  double cell_size = 0;
  std::vector<std::int32_t> x_steps = {}, y_steps = {}, height_steps = {};  ///< heights [mm]
  std::vector<std::uint16_t> sigmas = {};                                   ///< [mm]
  std::vector<std::uint8_t> beliefs = {};                                   ///< [1/255]
};

template <typename A>
void Serialize(A& archive, StoredSurface& stored) {
  archive(stored.cell_size, stored.x_steps, stored.y_steps, stored.height_steps, stored.sigmas,
          stored.beliefs);
}

std::int32_t Millimeters(float meters) {
  return static_cast<std::int32_t>(std::lround(1000 * static_cast<double>(meters)));
}

SurfaceMap Restored(const StoredSurface& stored) {
  const size_t count = stored.x_steps.size();
  Require(stored.cell_size > 0 && stored.y_steps.size() == count &&
              stored.height_steps.size() == count && stored.sigmas.size() == count &&
              stored.beliefs.size() == count,
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

/// Packs bytes as they come into one frame that states its length.
class FrameWriter {
 public:
  FrameWriter(std::ostream& stream, std::uint64_t num_bytes)
      : stream_(stream),
        context_(ZSTD_createCCtx(), ZSTD_freeCCtx),
        packed_(ZSTD_CStreamOutSize(), '\0') {
    Require(context_ != nullptr, ErrorCode::kInternal, "no memory for zstd");
    ZSTD_CCtx_setParameter(context_.get(), ZSTD_c_compressionLevel, kCompressionLevel);
    ZSTD_CCtx_setParameter(context_.get(), ZSTD_c_checksumFlag, 1);
    ZSTD_CCtx_setPledgedSrcSize(context_.get(), num_bytes);
  }

  template <typename Value>
  void Add(const Value& value) {
    const auto* bytes = reinterpret_cast<const char*>(&value);
    pending_.append(bytes, sizeof value);
    if (pending_.size() >= kBatch) Pack(ZSTD_e_continue);
  }

  void Finish() { Pack(ZSTD_e_end); }

 private:
  static constexpr size_t kBatch = 1 << 20;

  void Pack(ZSTD_EndDirective directive) {
    ZSTD_inBuffer input{pending_.data(), pending_.size(), 0};
    for (size_t left = 1; directive == ZSTD_e_end ? left > 0 : input.pos < input.size;) {
      ZSTD_outBuffer output{packed_.data(), packed_.size(), 0};
      left = ZSTD_compressStream2(context_.get(), &output, &input, directive);
      Require(ZSTD_isError(left) == 0, ErrorCode::kInternal, "zstd cannot compress the surface");
      stream_.write(packed_.data(), static_cast<std::streamsize>(output.pos));
    }
    pending_.clear();
  }

  std::ostream& stream_;
  std::unique_ptr<ZSTD_CCtx, size_t (*)(ZSTD_CCtx*)> context_;
  std::string pending_, packed_;
};

/// A column of StoredSurface: how many there are, and what `value_of` says of each cell.
template <typename Value, typename ValueOf>
void AddColumn(const SurfaceMap& surface, const ValueOf& value_of, FrameWriter& frame) {
  frame.Add(std::uint64_t{surface.cells.size()});
  ForEachReleasing(surface.cells,
                   [&](size_t i) { frame.Add(static_cast<Value>(value_of(surface.cells[i]))); });
}

/// The same with differences from the cell before.
template <typename ValueOf>
void AddSteps(const SurfaceMap& surface, const ValueOf& value_of, FrameWriter& frame) {
  std::int32_t last = 0;
  AddColumn<std::int32_t>(
      surface,
      [&](const SurfaceCell& cell) { return value_of(cell) - std::exchange(last, value_of(cell)); },
      frame);
}

/// Writes the layout of StoredSurface into a file, which may be larger than memory.
void WriteFrame(const SurfaceMap& surface, std::ostream& stream) {
  constexpr size_t kNumColumns = 5,
                   kBytesPerCell = 3 * sizeof(std::int32_t) + sizeof(std::uint16_t) + 1;
  FrameWriter frame(stream, sizeof(double) + kNumColumns * sizeof(std::uint64_t) +
                                kBytesPerCell * surface.cells.size());
  frame.Add(surface.cell_size);
  AddSteps(
      surface, [](const SurfaceCell& cell) { return std::int32_t{cell.x}; }, frame);
  AddSteps(
      surface, [](const SurfaceCell& cell) { return std::int32_t{cell.y}; }, frame);
  AddSteps(
      surface, [](const SurfaceCell& cell) { return Millimeters(cell.height); }, frame);
  AddColumn<std::uint16_t>(
      surface,
      [](const SurfaceCell& cell) {
        return std::min<std::int32_t>(Millimeters(cell.height_sigma), UINT16_MAX);
      },
      frame);
  AddColumn<std::uint8_t>(
      surface,
      [](const SurfaceCell& cell) {
        return std::lround(255 * static_cast<double>(cell.free_belief));
      },
      frame);
  frame.Finish();
}

std::string Decompress(std::string_view packed) {
  const unsigned long long size = ZSTD_getFrameContentSize(packed.data(), packed.size());
  Require(size <= kMaxBytes, ErrorCode::kInvalidInput,
          "it does not say how long it is");  // errors are huge numbers
  std::string bytes(size, '\0');
  const size_t unpacked = ZSTD_decompress(bytes.data(), bytes.size(), packed.data(), packed.size());
  Require(ZSTD_isError(unpacked) == 0 && unpacked == size, ErrorCode::kInvalidInput,
          "it is damaged");
  return bytes;
}

SurfaceMap Parse(std::string_view bytes) {
  Require(bytes.starts_with(kMagic), ErrorCode::kInvalidInput, "it holds no surface");
  bytes.remove_prefix(kMagic.size());
  std::uint32_t version = 0;
  BinaryReader head(bytes);
  head(version);
  Require(version == kLayoutVersion, ErrorCode::kInvalidInput,
          "it is of version " + std::to_string(version) + ", this program reads " +
              std::to_string(kLayoutVersion));
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
  BinaryWriter head;
  std::uint32_t version = kLayoutVersion;
  head(version);
  WriteFileAtomically(file, [&](const std::filesystem::path& temporary) {
    std::ofstream stream(temporary, std::ios::binary);
    stream << kMagic << head.bytes();
    WriteFrame(surface, stream);
    stream.close();
    Require(!stream.fail(), errno == ENOSPC ? ErrorCode::kDiskFull : ErrorCode::kInternal,
            "cannot write '" + file.filename().string() + "'");
  });
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
