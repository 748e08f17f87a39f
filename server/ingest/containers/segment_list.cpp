#include "server/ingest/containers/segment_list.h"

#include <algorithm>
#include <utility>

#include "server/ingest/containers/chunk_content.h"

namespace parkade {
namespace {

constexpr std::uint64_t kSegmentSize = std::uint64_t{2} << 20;

}  // namespace

void SegmentList::Add(const LogRecord& record, std::uint64_t held_size, const TimeSpan& time) {
  const bool is_large_chunk =
      record.kind == RecordKind::kChunk && record.unpacked_size > kMaxHeldChunk;
  is_new_due_ |=
      record.begin < covered_end_ || (!segments_.empty() && segments_.back().end < covered_end_);
  covered_end_ = std::max(covered_end_, record.end);
  const bool fits = !segments_.empty() && !is_new_due_ && !is_large_chunk &&
                    !segments_.back().is_large_chunk && !record.is_at_end &&
                    record.end - segments_.back().begin <= kSegmentSize &&
                    held_size + segments_.back().held_size <= kSegmentSize;
  is_new_due_ = false;
  if (!fits) {
    segments_.push_back(
        {record.begin, record.end, held_size, time, is_large_chunk, record.is_at_end});
    return;
  }
  segments_.back().end = record.end;
  segments_.back().held_size += held_size;
  if (time.IsEmpty()) return;
  segments_.back().time.Include(time.begin);
  segments_.back().time.Include(time.end);
}

std::vector<LogSegment> SegmentList::TakeSorted() {
  std::sort(segments_.begin(), segments_.end(),
            [](const LogSegment& a, const LogSegment& b) { return a.begin < b.begin; });
  return std::exchange(segments_, {});
}

}  // namespace parkade
