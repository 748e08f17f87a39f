#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

#include "core/error.h"
#include "core/timestamp.h"

namespace parkade {

// Two readers with the same members, so that one schema walk serves both encodings. Every length is
// checked against the bytes that are left: beyond them Error{kInvalidInput} is thrown and nothing
// is read.

namespace internal {

inline void RequireBytes(std::size_t wanted, std::size_t left) {
  Require(wanted <= left, ErrorCode::kInvalidInput, "the message ends inside a field");
}

template <typename T>
T SwapBytes(T value) {
  auto* bytes = reinterpret_cast<unsigned char*>(&value);
  for (std::size_t i = 0; i < sizeof(T) / 2; ++i) std::swap(bytes[i], bytes[sizeof(T) - 1 - i]);
  return value;
}

}  // namespace internal

/// ROS 1: little endian, packed. http://wiki.ros.org/msg
class Ros1Reader {
 public:
  static constexpr bool kHeaderHasSequence = true;

  explicit Ros1Reader(std::span<const std::uint8_t> data) : data_(data) {}

  template <typename T>
  T Read() {
    static_assert(std::is_arithmetic_v<T> && std::endian::native == std::endian::little);
    internal::RequireBytes(sizeof(T), data_.size());
    T value;
    std::memcpy(&value, data_.data(), sizeof(T));
    data_ = data_.subspan(sizeof(T));
    return value;
  }

  std::string_view ReadString() {
    const auto bytes = ReadBytes();
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }

  std::span<const std::uint8_t> ReadBytes() { return ReadBytes(Read<std::uint32_t>()); }

  std::span<const std::uint8_t> ReadBytes(std::size_t size) {
    internal::RequireBytes(size, data_.size());
    const auto bytes = data_.first(size);
    data_ = data_.subspan(size);
    return bytes;
  }

  void SkipWideString() { ReadBytes(); }

  /// The number of elements that follow; at least `min_element_size` bytes each must be left.
  std::size_t ReadCount(std::size_t min_element_size) {
    const auto count = Read<std::uint32_t>();
    internal::RequireBytes(count * min_element_size, data_.size());
    return count;
  }

 private:
  std::span<const std::uint8_t> data_;
};

/// CDR with its 4-byte encapsulation header, as ROS 2 writes it: plain CDR version 1 or 2 in either
/// byte order. OMG DDS-XTYPES 1.3, 7.4.
class CdrReader {
 public:
  static constexpr bool kHeaderHasSequence = false;

  explicit CdrReader(std::span<const std::uint8_t> data) {
    internal::RequireBytes(kHeaderSize, data.size());
    const unsigned representation = static_cast<unsigned>(data[0] << 8 | data[1]);
    is_swapped_ = (representation & 1) == 0;
    const unsigned kind = representation & ~1U;
    Require(kind == kPlainCdr || kind == kPlainCdr2, ErrorCode::kInvalidInput,
            "the message is in a CDR representation that is not supported");
    max_alignment_ = kind == kPlainCdr ? 8 : 4;
    data_ = data.subspan(kHeaderSize);
  }

  template <typename T>
  T Read() {
    static_assert(std::is_arithmetic_v<T> && std::endian::native == std::endian::little);
    Align(sizeof(T));
    internal::RequireBytes(sizeof(T), data_.size() - position_);
    T value;
    std::memcpy(&value, data_.data() + position_, sizeof(T));
    position_ += sizeof(T);
    return is_swapped_ ? internal::SwapBytes(value) : value;
  }

  /// A string without the terminating NUL, which CDR counts.
  std::string_view ReadString() {
    const auto bytes = ReadBytes();
    std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (!text.empty() && text.back() == '\0') text.remove_suffix(1);
    return text;
  }

  std::span<const std::uint8_t> ReadBytes() { return ReadBytes(Read<std::uint32_t>()); }

  std::span<const std::uint8_t> ReadBytes(std::size_t size) {
    internal::RequireBytes(size, data_.size() - position_);
    const auto bytes = data_.subspan(position_, size);
    position_ += size;
    return bytes;
  }

  /// Passes over a wstring. Its characters have four bytes, since Fast CDR 2 two: nobody says
  /// which, but two of them are hardly one of Unicode's.
  void SkipWideString() {
    constexpr std::uint32_t kLastOfUnicode = 0x10ffff;
    const std::size_t count = Read<std::uint32_t>();
    CdrReader wide = *this;
    bool is_wide = 4 * count <= data_.size() - position_;
    for (std::size_t i = 0; is_wide && i < count; ++i)
      is_wide = wide.Read<std::uint32_t>() <= kLastOfUnicode;
    ReadBytes((is_wide ? 4 : 2) * count);
  }

  std::size_t ReadCount(std::size_t min_element_size) {
    const auto count = Read<std::uint32_t>();
    internal::RequireBytes(count * min_element_size, data_.size() - position_);
    return count;
  }

 private:
  static constexpr std::size_t kHeaderSize = 4;
  static constexpr unsigned kPlainCdr = 0x0000, kPlainCdr2 = 0x0006;

  void Align(std::size_t size) {
    const std::size_t alignment = size < max_alignment_ ? size : max_alignment_;
    const std::size_t aligned = (position_ + alignment - 1) / alignment * alignment;
    internal::RequireBytes(aligned - position_, data_.size() - position_);
    position_ = aligned;
  }

  std::span<const std::uint8_t> data_;
  std::size_t position_ = 0;
  std::size_t max_alignment_ = 8;
  bool is_swapped_ = false;
};

}  // namespace parkade
