#pragma once

#include <memory>
#include <vector>

#include "server/ingest/containers/log_format.h"
#include "server/ingest/containers/raw_message.h"

namespace parkade {

/// A stretch of a log that is read at once: one chunk, or small neighbors.
struct LogSegment {
  std::uint64_t begin = 0, end = 0;  ///< in the file
  std::uint64_t held_size = 0;       ///< [byte] of memory while it is read
  TimeSpan time;                     ///< of its messages, as far as the headers tell
  bool is_large_chunk = false;       ///< above kMaxHeldChunk
  bool is_at_end = false;            ///< a chunk that is_at_end
};

/// The result of one look at the headers of a log.
struct ScannedLog {
  std::shared_ptr<const InputFile> file;
  const LogFormat* format = nullptr;
  TopicMap topics;
  std::vector<LogSegment> segments;  ///< in order of the file; about 2 MiB or one chunk each
  DamageReport damage;               ///< of the structure; chunks are not unpacked yet
};

/// Hops from header to header, past damage. Unpacks a chunk only where the headers leave open which
/// topics or times it holds.
ScannedLog ScanLog(std::shared_ptr<const InputFile> file, const LogFormat& format);

}  // namespace parkade
