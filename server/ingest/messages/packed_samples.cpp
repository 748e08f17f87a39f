#include "server/ingest/messages/packed_samples.h"

namespace parkade {

std::optional<PackedEncoding> FindPackedEncoding(const std::string& encoding) {
  if (!encoding.starts_with("mono") && !encoding.starts_with("bayer_")) return std::nullopt;
  for (const int bits : {10, 12}) {
    const std::string suffix = std::to_string(bits) + "p";
    if (!encoding.ends_with(suffix)) continue;
    return PackedEncoding{encoding.substr(0, encoding.size() - suffix.size()) + "8", bits};
  }
  return std::nullopt;
}

std::optional<std::vector<std::uint8_t>> UpperEightBits(const ImageMessage& message, int bits) {
  const std::size_t width = message.width, height = message.height,
                    sample_bits = static_cast<std::size_t>(bits);
  const std::size_t row_size = (width * sample_bits + 7) / 8;
  const std::size_t step = message.step == 0 ? row_size : message.step;
  if (width == 0 || height == 0 || step < row_size ||
      message.data.size() < step * (height - 1) + row_size)
    return std::nullopt;
  std::vector<std::uint8_t> upper;
  upper.reserve(width * height);
  for (std::size_t y = 0; y < height; ++y) {
    const std::uint8_t* row = message.data.data() + y * step;
    for (std::size_t x = 0; x < width; ++x) {
      const std::size_t first_bit = (x + 1) * sample_bits - 8;
      const std::size_t byte = first_bit / 8, shift = first_bit % 8;
      const unsigned above = shift > 0 ? row[byte + 1] : 0U;
      upper.push_back(static_cast<std::uint8_t>((above << 8 | row[byte]) >> shift));
    }
  }
  return upper;
}

}  // namespace parkade
