#pragma once

#include <optional>

#include "server/ingest/containers/log_format.h"

namespace parkade {

/// Goes from record to record, and past damage to the next place where records make sense again.
///
/// A record is believed when another follows it. Where none does, the bytes behind its beginning
/// are searched for the next record that can be believed: if none lies inside it, the bytes behind
/// it are the damaged ones. A chunk ends at the latest where the next record begins.
class RecordWalker {
 public:
  struct Step {
    std::optional<LogRecord> record;  ///< set, too, for damaged messages whose header could be read
    bool is_damaged = false;          ///< [offset, next) holds nothing that can be believed
    std::uint64_t next = 0;           ///< where to go on
  };

  /// Borrows both arguments, which must outlive the walker.
  RecordWalker(const LogFormat& format, ByteReader& reader) : format_(&format), reader_(&reader) {}

  /// The record or the damage at `offset`, which must be below reader.size().
  Step At(std::uint64_t offset);

 private:
  Step StepOverChunk(LogRecord chunk);
  bool IsFollowed(const LogRecord& record) const;
  bool IsBelieved(const LogRecord& record) const;
  std::uint64_t FindNext(std::uint64_t begin);
  std::uint64_t Find(std::uint64_t begin, bool (*is_sought)(RecordKind)) const;

  const LogFormat* format_;
  ByteReader* reader_;
  std::uint64_t searched_begin_ = 0, searched_end_ = 0;  ///< nothing to believe in between
};

}  // namespace parkade
