#pragma once

#include <cstdint>
#include <vector>

#include "server/ingest/containers/log_record.h"

namespace parkade {

/// A stretch of a log that is read at once: one chunk, or small neighbors.
struct LogSegment {
  std::uint64_t begin = 0, end = 0;  ///< in the file
  std::uint64_t held_size = 0;       ///< [byte] of memory while it is read
  TimeSpan time;                     ///< of its messages, as far as the headers tell
  bool is_large_chunk = false;       ///< above kMaxHeldChunk
  bool is_at_end = false;            ///< a chunk that is_at_end
};

/// Puts the records of a log together to segments.
class SegmentList {
 public:
  /// Adds a chunk, or a message outside of chunks.
  void Add(const LogRecord& record, std::uint64_t held_size, const TimeSpan& time);
  /// The next record begins a segment.
  void BeginNew() { is_new_due_ = true; }
  /// The segment that was begun last; null before the first. Valid until the next call.
  const LogSegment* last() const { return segments_.empty() ? nullptr : &segments_.back(); }
  /// All segments in order of the file.
  std::vector<LogSegment> TakeSorted();

 private:
  std::vector<LogSegment> segments_;
  bool is_new_due_ = true;
  std::uint64_t covered_end_ = 0;  ///< of all segments
};

}  // namespace parkade
