#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/ingest/files/input_file.h"

namespace parkade {

/// Bytes read by their offset. Thread-compatible.
class ByteReader {
 public:
  virtual ~ByteReader() = default;

  /// The offset behind the last byte there may be.
  virtual std::uint64_t size() const = 0;

  /// `count` bytes from `offset` on, or fewer where they end. Valid until the next call.
  virtual std::span<const std::uint8_t> Fetch(std::uint64_t offset, std::size_t count) = 0;

  /// Promises that nothing before `offset` is fetched again.
  virtual void Release(std::uint64_t offset) { static_cast<void>(offset); }
};

/// Reads memory, which must outlive the reader.
class MemoryReader : public ByteReader {
 public:
  explicit MemoryReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  std::uint64_t size() const override { return bytes_.size(); }
  std::span<const std::uint8_t> Fetch(std::uint64_t offset, std::size_t count) override {
    if (offset >= bytes_.size()) return {};
    return bytes_.subspan(offset,
                          std::min(count, bytes_.size() - static_cast<std::size_t>(offset)));
  }

 private:
  std::span<const std::uint8_t> bytes_;
};

/// Reads a file up to byte `end`, through a window: small after a jump, so that hopping from header
/// to header stays cheap, growing while the offsets go on.
class FileReader : public ByteReader {
 public:
  FileReader(const InputFile& file, std::uint64_t end)
      : file_(&file), end_(std::min(end, file.size())) {}

  std::uint64_t size() const override { return end_; }
  std::span<const std::uint8_t> Fetch(std::uint64_t offset, std::size_t count) override;

 private:
  const InputFile* file_;
  std::uint64_t end_;
  std::uint64_t window_begin_ = 0;
  std::vector<std::uint8_t> window_;
  std::size_t step_ = 0;
};

/// The little-endian number at the front of `bytes`, which must be long enough.
template <typename T>
T LoadNumber(std::span<const std::uint8_t> bytes) {
  static_assert(std::endian::native == std::endian::little);
  T value;
  std::memcpy(&value, bytes.data(), sizeof(T));
  return value;
}

/// The number at `offset`; nothing beyond the end.
template <typename T>
std::optional<T> ReadNumber(ByteReader& reader, std::uint64_t offset) {
  const std::span<const std::uint8_t> bytes = reader.Fetch(offset, sizeof(T));
  if (bytes.size() < sizeof(T)) return std::nullopt;
  return LoadNumber<T>(bytes);
}

/// The text of `size` bytes at `offset`; nothing beyond the end or above `max_size`.
std::optional<std::string> ReadText(ByteReader& reader, std::uint64_t offset, std::uint64_t size,
                                    std::uint64_t max_size);

}  // namespace parkade
