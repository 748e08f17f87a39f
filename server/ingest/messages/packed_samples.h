#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "server/ingest/messages/message_decoding.h"

namespace parkade {

/// An encoding of samples of 10 or 12 bits that follow each other without a gap, the lowest bit
/// first, each row from a whole byte: GenICam's "10p" and "12p" (Pixel Format Naming Convention
/// 2.1, 6.2), as in mono10p or bayer_rggb12p.
struct PackedEncoding {
  std::string eight_bit;  ///< the encoding of the samples' upper eight bits
  int bits = 10;          ///< of a sample
};

/// `encoding`: in small letters. Nothing where it is not packed.
std::optional<PackedEncoding> FindPackedEncoding(const std::string& encoding);

/// The upper eight bits of each sample, row by row; nothing when there are fewer bytes than the
/// size needs.
std::optional<std::vector<std::uint8_t>> UpperEightBits(const ImageMessage& message, int bits);

}  // namespace parkade
