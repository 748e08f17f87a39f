#pragma once

#include <optional>

#include "server/ingest/log_format.h"

namespace parkade {

/// Goes from record to record, and past damage to the next place where records make sense again.
///
/// A record is believed when its own fields confirm its length, or when another record follows it. Where neither holds,
/// the bytes behind its beginning are searched for the next record that can be believed: if none lies inside it, it is
/// what follows that is damaged.
class RecordWalker {
 public:
  struct Step {
    std::optional<LogRecord> record;  ///< also of damaged messages whose header could be read
    bool is_damaged = false;          ///< [offset, next) holds nothing that can be believed
    std::uint64_t next = 0;           ///< where to go on
  };

  /// Both must outlive the walker.
  RecordWalker(const LogFormat& format, ByteReader& reader) : format_(&format), reader_(&reader) {}

  /// `offset` < reader.size().
  Step At(std::uint64_t offset);

 private:
  bool IsFollowed(const LogRecord& record) const;
  std::uint64_t FindNext(std::uint64_t begin);

  const LogFormat* format_;
  ByteReader* reader_;
  std::uint64_t searched_begin_ = 0, searched_end_ = 0;  ///< nothing to believe in between
};

}  // namespace parkade
