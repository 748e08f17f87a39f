#pragma once

#include <memory>
#include <vector>

#include "server/ingest/containers/log_scanner.h"

namespace parkade {

/// The messages of one segment; in order of log_time as far as that is possible in bounded memory.
class SegmentCursor {
 public:
  virtual ~SegmentCursor() = default;
  /// Log time of the next message; nothing at the end.
  virtual std::optional<Timestamp> NextTime() = 0;
  virtual RawMessage Take() = 0;
};

/// The order of the messages of a segment.
enum class SegmentOrder { kLogTime, kFile };

/// Opens a segment; losses, now and later, are added to `damage`. All arguments must outlive the
/// cursor.
std::unique_ptr<SegmentCursor> OpenSegment(const ScannedLog& log, const LogSegment& segment,
                                           const std::vector<bool>& wanted, SegmentOrder order,
                                           DamageReport& damage);

/// The message at a place that a cursor gave, without its neighbors; nothing where it cannot be
/// read. Unpacks its chunk. Its topic is -1 where the log does not define it.
std::optional<RawMessage> ReadMessageAt(const ScannedLog& log, const MessagePlace& place);

}  // namespace parkade
