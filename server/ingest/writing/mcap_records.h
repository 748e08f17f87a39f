#pragma once

#include <array>
#include <cstdint>

namespace parkade {

/// What MCAP files consist of. Opcodes of mcap.dev/spec.
struct McapRecord {
  enum Opcode : std::uint8_t {
    kHeader = 1,
    kFooter = 2,
    kSchema = 3,
    kChannel = 4,
    kMessage = 5,
    kChunk = 6,
    kMessageIndex = 7,
    kChunkIndex = 8,
    kAttachment = 9,
    kAttachmentIndex = 10,
    kStatistics = 11,
    kMetadata = 12,
    kMetadataIndex = 13,
    kSummaryOffset = 14,
    kDataEnd = 15,
  };

  /// What a file begins and ends with.
  static constexpr std::array<std::uint8_t, 8> kMagic = {0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};
};

}  // namespace parkade
