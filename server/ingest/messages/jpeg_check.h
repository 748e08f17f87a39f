#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace parkade {

/// Walks through the entropy-coded data of a baseline JPEG and names the first thing that no
/// encoder writes: an unknown Huffman code, a run beyond the block, a coefficient larger than any
/// 8-bit image has, data that do not end where the image does, padding that is neither ones nor
/// zeros, restart markers out of order, a missing EOI. libjpeg forgives many of these. No codec can
/// tell a bit that changes a coefficient, or a table, into another possible one. ITU-T T.81, F.2.
/// Returns nothing for progressive and arithmetic-coded files and those without Huffman tables,
/// which libjpeg alone judges. `data` has passed libjpeg's header check. Cost: about that of
/// decoding in grayscale.
std::optional<std::string> FindJpegDamage(std::span<const std::uint8_t> data);

}  // namespace parkade
