#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace parkade {

/// Bits of one entropy-coded segment whose stuffed zeros are already taken out. Beyond its end come
/// zeros, and `IsOverrun` turns true.
class JpegBits {
 public:
  explicit JpegBits(std::span<const std::uint8_t> data) : data_(data) {}

  /// The next 16 bits without taking them.
  unsigned Peek16() {
    if (num_bits_ < 16) [[unlikely]]
      Refill();
    return static_cast<unsigned>(window_ >> 48);
  }

  void Skip(int count) {
    window_ <<= count;
    num_bits_ -= count;
  }

  bool IsOverrun() const { return Position() > 8 * data_.size(); }

  /// True when the bits that are left of the byte are alike, and only bytes of zero follow it, with
  /// which some cameras fill up their packets. Where these begin earlier, the data are lost.
  bool IsAtPaddedEnd() {
    const std::size_t size = 8 * data_.size(), position = Position();
    if (position > size) return false;
    const auto left = static_cast<int>((size - position) % 8);
    const unsigned padding = Peek16() >> (16 - left);
    if (padding != 0 && padding != (1U << left) - 1) return false;
    constexpr std::size_t kMostZeros = 4;  // that a coder may well end with
    const auto filling = data_.last((size - position) / 8);
    const auto coded = data_.first(data_.size() - filling.size());
    const auto is_zero = [](std::uint8_t byte) { return byte == 0; };
    const auto end_of_code = coded.last(std::min(coded.size(), kMostZeros));
    return filling.empty() || (std::all_of(filling.begin(), filling.end(), is_zero) &&
                               !std::all_of(end_of_code.begin(), end_of_code.end(), is_zero));
  }

 private:
  /// How many bits were taken so far.
  std::size_t Position() const { return 8 * next_byte_ - static_cast<std::size_t>(num_bits_); }

  void Refill() {
    if (next_byte_ + sizeof(std::uint64_t) <= data_.size()) {
      std::uint64_t word;
      std::memcpy(&word, data_.data() + next_byte_, sizeof(word));
      const int num_bytes = (64 - num_bits_) / 8;
      // Fills in whole bytes only: bits below them in the window would be in the way next time.
      const int num_kept = num_bits_ + 8 * num_bytes;
      window_ |= __builtin_bswap64(word) >> num_bits_;
      if (num_kept < 64) window_ &= ~std::uint64_t{0} << (64 - num_kept);
      next_byte_ += static_cast<std::size_t>(num_bytes);
      num_bits_ = num_kept;
      return;
    }
    while (num_bits_ <= 56) {
      const std::uint64_t byte = next_byte_ < data_.size() ? data_[next_byte_] : 0;
      ++next_byte_;
      window_ |= byte << (56 - num_bits_);
      num_bits_ += 8;
    }
  }

  std::span<const std::uint8_t> data_;
  std::size_t next_byte_ = 0;
  std::uint64_t window_ = 0;  ///< next bits, the first one on top
  int num_bits_ = 0;
};

/// One Huffman table of a DHT segment. ITU-T T.81, annex C.
class JpegHuffmanTable {
 public:
  /// `counts`: codes of 1 to 16 bits; `values` in order of code. False when the codes do not fit.
  bool Build(std::span<const std::uint8_t, 16> counts, std::span<const std::uint8_t> values);

  struct Symbol {
    std::uint8_t value = 0;
    std::uint8_t length = 0;  ///< [bits]; 0: no such code
  };

  Symbol Find(unsigned next_16_bits) const {
    const Symbol symbol = short_codes_[next_16_bits >> (16 - kShortLength)];
    return symbol.length > 0 ? symbol : FindLong(next_16_bits);
  }

 private:
  static constexpr int kShortLength = 9;

  Symbol FindLong(unsigned next_16_bits) const;

  std::array<Symbol, 1 << kShortLength> short_codes_{};
  std::array<std::int32_t, 17>
      end_of_length_{};  ///< one past the last code of a length, shifted to 16 bits
  std::array<std::int32_t, 17> value_offset_{};  ///< index of a code's value = code + offset
  std::vector<std::uint8_t> values_;
};

}  // namespace parkade
