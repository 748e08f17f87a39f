#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace parkade {

/// How a writer packs its chunks. MCAP knows none, lz4, zstd; ROS 1 bags none, bz2, lz4.
enum class LogCompression { kNone, kLz4, kZstd, kBz2 };

/// "", "lz4", "zstd", "bz2"
const char* NameOf(LogCompression compression);

/// The bytes as one lz4 frame (with a content checksum, as roslz4 writes), zstd frame or bzip2
/// stream.
std::vector<std::uint8_t> Compress(std::span<const std::uint8_t> bytes, LogCompression compression);

}  // namespace parkade
