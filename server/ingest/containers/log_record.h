#pragma once

#include <cstdint>
#include <optional>

#include "core/timestamp.h"
#include "server/ingest/containers/chunk_codec.h"

namespace parkade {

enum class RecordKind {
  kMessage,
  kChunk,       ///< packed messages and definitions
  kChunkIndex,  ///< behind a chunk: time and offset of its messages of one channel
  kDefinition,  ///< of a channel, or of a message type
  kOther,
  kUnknown,  ///< may be a record that is newer than this reader, or no record at all
};

/// The header of one record of a log: what ROS 1 bags and MCAP have in common. Offsets are the
/// reader's.
struct LogRecord {
  RecordKind kind = RecordKind::kOther;
  std::uint64_t begin = 0, end = 0;  ///< `end` as the record claims: it may lie behind the file's
  std::uint64_t data_begin = 0;   ///< message bytes, packed bytes, index entries, or the definition
  std::uint64_t data_size = 0;    ///< [byte]
  bool is_exact = false;          ///< two fields agree on the length: a damaged length is ruled out
  bool is_unmistakable = false;   ///< nothing else looks like this header
  std::uint32_t channel = 0;      ///< of a message or an index
  Timestamp time;                 ///< of a message
  std::uint64_t num_entries = 0;  ///< of an index
  ChunkCompression compression = ChunkCompression::kNone;
  std::uint64_t unpacked_size = 0;        ///< [byte] of a chunk, as it claims
  std::optional<std::uint32_t> checksum;  ///< CRC-32 of the unpacked chunk
  TimeSpan span;                          ///< of a chunk, where its header tells
  bool is_at_end = false;  ///< a chunk that no record follows: what there is of it was written
                           ///< before the end came
};

/// Messages above this size are not read [byte].
constexpr std::uint64_t kMaxMessageSize = std::uint64_t{64} << 20;

}  // namespace parkade
