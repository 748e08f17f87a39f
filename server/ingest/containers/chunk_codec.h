#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "server/ingest/files/input_file.h"

namespace parkade {

enum class ChunkCompression { kNone, kLz4, kZstd, kBz2 };

/// The compression by its name: "", "none", "lz4", "zstd" or "bz2".
std::optional<ChunkCompression> CompressionNamed(std::string_view name);

/// Unpacks one stream of lz4 frames, zstd frames or bzip2, piece by piece, in memory that does not
/// depend on its size.
class Unpacker {
 public:
  struct Step {
    std::size_t num_consumed = 0, num_produced = 0;
    bool is_at_end = false;  ///< a frame is complete
  };

  virtual ~Unpacker() = default;
  /// Takes some of `packed`, fills some of `out`. Throws Error{kInvalidInput} when the bytes are
  /// damaged.
  virtual Step Run(std::span<const std::uint8_t> packed, std::span<std::uint8_t> out) = 0;
};

std::unique_ptr<Unpacker> MakeUnpacker(ChunkCompression compression);

/// A packed stretch of a file, unpacked from front to back.
class UnpackingStream {
 public:
  enum class State {
    kRunning,
    kEnded,    ///< all was unpacked
    kCut,      ///< the stretch ended before the packed stream did
    kDamaged,  ///< the packed bytes are wrong
  };

  /// `file` must outlive the stream.
  UnpackingStream(const InputFile& file, std::uint64_t begin, std::uint64_t size,
                  ChunkCompression compression);

  /// Fills `out`. Returns less than its size only at the end, about which state() tells.
  std::size_t Read(std::span<std::uint8_t> out);
  State state() const { return state_; }

 private:
  std::size_t ReadPlain(std::span<std::uint8_t> out);
  bool Refill();

  const InputFile* file_;
  std::uint64_t next_, end_;  ///< packed bytes of the file that are still to be read
  std::unique_ptr<Unpacker> unpacker_;
  std::vector<std::uint8_t> packed_;
  std::span<const std::uint8_t> rest_;  ///< of packed_
  bool is_in_frame_ = true;
  State state_ = State::kRunning;
};

/// Unpacks the bytes of a message from a recorder that packs each message with zstd. Throws
/// Error{kInvalidInput} when they are damaged or unpack to more than `max_size`.
std::vector<std::uint8_t> UnpackZstd(std::span<const std::uint8_t> packed, std::size_t max_size);

/// True for the first bytes of a zstd frame. No CDR message starts so.
bool IsZstd(std::span<const std::uint8_t> bytes);

/// CRC-32 as in zlib, MCAP and Ethernet; `crc` is that of the bytes before.
std::uint32_t UpdateCrc32(std::uint32_t crc, std::span<const std::uint8_t> bytes);

}  // namespace parkade
