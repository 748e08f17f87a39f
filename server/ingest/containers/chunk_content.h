#pragma once

#include <memory>
#include <string>
#include <vector>

#include "server/ingest/containers/log_record.h"
#include "server/ingest/files/byte_reader.h"

namespace parkade {

/// Chunks up to this size are unpacked as a whole, larger ones piece by piece [byte].
constexpr std::uint64_t kMaxHeldChunk = std::uint64_t{16} << 20;

/// The checked content of a chunk.
struct ChunkContent {
  std::unique_ptr<ByteReader> reader;  ///< of the unpacked bytes; null when none can be trusted
  std::vector<std::uint8_t> bytes;     ///< where they were unpacked as a whole: what `reader` reads
  std::string problem;  ///< a sentence about what is missing; empty: the chunk is whole
};

/// Unpacks a chunk of `file`, which must outlive the content. A chunk that is damaged (wrong
/// checksum or size, broken compression, above 1 GiB) is lost as a whole, for no one can tell which
/// of its messages are good. Bytes before the end of a log that ends inside the chunk are kept, and
/// so is a plain chunk without checksum.
ChunkContent OpenChunk(const InputFile& file, const LogRecord& chunk);

/// The bytes that come out of a damaged chunk, at most kMaxHeldChunk of them. Any of them may be
/// wrong.
std::vector<std::uint8_t> UnpackDamagedChunk(const InputFile& file, const LogRecord& chunk);

}  // namespace parkade
