#include "server/ingest/messages/jpeg_bits.h"

namespace parkade {

bool JpegHuffmanTable::Build(std::span<const std::uint8_t, 16> counts,
                             std::span<const std::uint8_t> values) {
  values_.assign(values.begin(), values.end());
  short_codes_.fill({});
  std::int32_t code = 0;
  std::size_t index = 0;
  for (int length = 1; length <= 16; ++length, code <<= 1) {
    const auto count = static_cast<std::int32_t>(counts[static_cast<std::size_t>(length - 1)]);
    value_offset_[static_cast<std::size_t>(length)] = static_cast<std::int32_t>(index) - code;
    if (code + count > 1 << length || index + static_cast<std::size_t>(count) > values_.size())
      return false;
    for (std::int32_t i = 0; i < count; ++i, ++code, ++index) {
      if (length > kShortLength) continue;
      const auto first = static_cast<std::size_t>(code) << (kShortLength - length);
      for (std::size_t tail = 0; tail < std::size_t{1} << (kShortLength - length); ++tail)
        short_codes_[first + tail] = {values_[index], static_cast<std::uint8_t>(length)};
    }
    end_of_length_[static_cast<std::size_t>(length)] = code << (16 - length);
  }
  return true;
}

JpegHuffmanTable::Symbol JpegHuffmanTable::FindLong(unsigned next_16_bits) const {
  for (std::size_t length = kShortLength + 1; length <= 16; ++length) {
    if (static_cast<std::int32_t>(next_16_bits) >= end_of_length_[length]) continue;
    const auto code = static_cast<std::int32_t>(next_16_bits >> (16 - length));
    const std::int32_t index = code + value_offset_[length];
    return {values_[static_cast<std::size_t>(index)], static_cast<std::uint8_t>(length)};
  }
  return {};
}

}  // namespace parkade
