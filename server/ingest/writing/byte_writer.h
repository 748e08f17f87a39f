#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

namespace parkade {

/// Appends little-endian numbers and bytes to a vector.
class ByteWriter {
 public:
  template <typename T>
  requires std::is_integral_v<T> ByteWriter& Number(T value) {
    for (std::size_t i = 0; i < sizeof(T); ++i)
      bytes_.push_back(
          static_cast<std::uint8_t>(static_cast<std::make_unsigned_t<T>>(value) >> (8 * i)));
    return *this;
  }
  ByteWriter& Bytes(std::span<const std::uint8_t> bytes) {
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    return *this;
  }
  ByteWriter& Text(std::string_view text) {
    bytes_.insert(bytes_.end(), text.begin(), text.end());
    return *this;
  }
  /// Its length as 32 bits, then the text.
  ByteWriter& PrefixedText(std::string_view text) {
    return Number(static_cast<std::uint32_t>(text.size())).Text(text);
  }

  const std::vector<std::uint8_t>& bytes() const { return bytes_; }
  std::size_t size() const { return bytes_.size(); }
  void Clear() { bytes_.clear(); }

 private:
  std::vector<std::uint8_t> bytes_;
};

}  // namespace parkade
