#include "server/ingest/containers/record_walker.h"

#include <algorithm>

namespace parkade {

RecordWalker::Step RecordWalker::At(std::uint64_t offset) {
  const std::optional<LogRecord> record = format_->Parse(*reader_, offset);
  if (!record) return {std::nullopt, true, FindNext(offset + 1)};
  const bool fits = record->end <= reader_->size();
  if (fits && IsFollowed(*record)) return {record, false, record->end};
  if (record->kind == RecordKind::kChunk) return StepOverChunk(*record);
  const std::uint64_t next = FindNext(offset + 1);
  if (fits && record->end <= next) return {record, false, record->end};
  return {record, true, next};
}

RecordWalker::Step RecordWalker::StepOverChunk(LogRecord chunk) {
  // Records lie in a chunk that is not packed, too: only a record that never lies in a chunk can
  // tell its end.
  const auto is_outside = [](RecordKind kind) {
    return kind != RecordKind::kMessage && kind != RecordKind::kDefinition;
  };
  const std::uint64_t next =
      chunk.is_exact ? Find(chunk.data_begin, is_outside) : FindNext(chunk.begin + 1);
  if (next <= chunk.data_begin && next < reader_->size()) return {chunk, true, next};
  chunk.is_at_end = next == reader_->size();
  chunk.end = std::min(chunk.end, next);
  chunk.data_size = chunk.end - std::min(chunk.data_begin, chunk.end);
  return {chunk, false, chunk.end};
}

bool RecordWalker::IsFollowed(const LogRecord& record) const {
  if (record.end == reader_->size()) return true;
  const std::optional<LogRecord> next = format_->Parse(*reader_, record.end);
  return next && next->kind != RecordKind::kUnknown;
}

bool RecordWalker::IsBelieved(const LogRecord& record) const {
  if (record.end > reader_->size()) return record.is_unmistakable;
  return record.is_exact || IsFollowed(record);
}

std::uint64_t RecordWalker::FindNext(std::uint64_t begin) {
  if (begin < searched_begin_ || begin >= searched_end_) {
    searched_begin_ = begin;
    searched_end_ = Find(begin, [](RecordKind) { return true; });
  }
  return searched_end_;
}

std::uint64_t RecordWalker::Find(std::uint64_t begin, bool (*is_sought)(RecordKind)) const {
  constexpr std::size_t kBlock = std::size_t{64} << 10, kOverlap = 15;
  for (std::uint64_t offset = begin; offset < reader_->size();) {
    const std::span<const std::uint8_t> block = reader_->Fetch(offset, kBlock);
    const std::size_t candidate = format_->FindCandidate(block, 0);
    if (candidate + kOverlap >= block.size()) {
      if (block.size() < kBlock) break;
      offset += block.size() - kOverlap;
      continue;
    }
    offset += candidate;
    const std::optional<LogRecord> record = format_->Parse(*reader_, offset);
    if (record && is_sought(record->kind) && IsBelieved(*record)) return offset;
    ++offset;
  }
  return reader_->size();
}

}  // namespace parkade
