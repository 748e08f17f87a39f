#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace parkade {

struct JpegFinding {
  bool is_judged = false;  ///< false: of a kind that libjpeg alone judges
  std::optional<std::string> damage;
};

/// Walks through the entropy-coded data of a baseline JPEG and names the first thing that no
/// encoder writes: an unknown Huffman code, a run beyond the block, a coefficient larger than any
/// 8-bit image has, data that do not end where the image does, padding that is neither ones nor
/// zeros, restart markers out of order, a missing EOI. libjpeg forgives many of these. Bytes of
/// zero between the coded data and the next marker are no damage. No codec can tell a bit that
/// changes a coefficient, or a table, into another possible one. ITU-T T.81, F.2. Progressive and
/// arithmetic-coded files are not judged. `data` has passed libjpeg's header check. Cost: about
/// that of decoding in grayscale.
JpegFinding FindJpegDamage(std::span<const std::uint8_t> data);

}  // namespace parkade
