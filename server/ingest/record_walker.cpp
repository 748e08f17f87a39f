#include "server/ingest/record_walker.h"

namespace parkade {

RecordWalker::Step RecordWalker::At(std::uint64_t offset) {
  std::optional<LogRecord> record = format_->Parse(*reader_, offset);
  if (record && record->end <= reader_->size() && (record->is_exact || IsFollowed(*record)))
    return {record, false, record->end};
  if (record && record->kind == RecordKind::kChunk && record->is_exact) {
    record->is_cut = true;  // the file ends inside of it
    record->data_size = reader_->size() - std::min(record->data_begin, reader_->size());
    record->end = reader_->size();
    return {record, false, record->end};
  }
  const std::uint64_t next = FindNext(offset + 1);
  if (!record) return {std::nullopt, true, next};
  if (record->end <= next && record->end <= reader_->size()) return {record, false, record->end};
  if (record->kind == RecordKind::kChunk && record->data_begin < next) {
    record->is_cut = true;  // its length is damaged, or the file ends: what follows tells its end
    record->data_size = next - record->data_begin;
    record->end = next;
    return {record, false, next};
  }
  return {record, true, next};
}

bool RecordWalker::IsFollowed(const LogRecord& record) const {
  return record.end == reader_->size() || format_->Parse(*reader_, record.end).has_value();
}

std::uint64_t RecordWalker::FindNext(std::uint64_t begin) {
  if (searched_begin_ <= begin && begin < searched_end_) return searched_end_;
  searched_begin_ = begin;
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
    if (record && record->end <= reader_->size() && (record->is_exact || IsFollowed(*record)))
      return searched_end_ = offset;
    ++offset;
  }
  return searched_end_ = reader_->size();
}

}  // namespace parkade
