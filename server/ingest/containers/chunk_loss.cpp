#include "server/ingest/containers/chunk_loss.h"

#include <map>

#include "server/ingest/containers/damage.h"
#include "server/ingest/containers/record_walker.h"

namespace parkade {

void KeptMessages::Add(std::uint32_t channel, Timestamp time) {
  constexpr std::size_t kMaxNoted = 200'000;  // bounds memory; chunks of real logs hold far fewer
  is_complete_ = stamps_.size() < kMaxNoted;
  if (is_complete_) stamps_.emplace(channel, time);
}

/// True when one of the index's messages was kept.
static bool HasKept(const ScannedLog& log, ByteReader& reader, const LogRecord& index,
                    const KeptMessages& kept) {
  bool has_kept = false;
  log.format->ReadIndex(reader, index, [&](const ChunkIndexEntry& entry) {
    has_kept |= kept.Contains(index.channel, entry.time);
  });
  return has_kept;
}

void AddChunkLoss(const ScannedLog& log, const LogRecord& chunk, const std::string& problem,
                  KeptMessages kept, const std::vector<bool>& wanted, DamageReport& damage) {
  FileReader reader(*log.file, log.format->EndOfRecords(*log.file));
  constexpr int kUndefined = -1;
  std::map<int, LostRange> losses;  // by topic
  bool has_index = false, is_behind_damage = false;
  RecordWalker walker(*log.format, reader);
  for (std::uint64_t offset = chunk.end; offset < reader.size();) {
    const RecordWalker::Step step = walker.At(offset);
    offset = step.next;
    is_behind_damage |= step.is_damaged;
    if (step.is_damaged) continue;
    const LogRecord& index = *step.record;
    if (index.kind == RecordKind::kMessage)
      kept.Add(index.channel, index.time);  // the message lies open behind a damaged chunk
    if (index.kind == RecordKind::kMessage || index.kind == RecordKind::kDefinition) continue;
    if (index.kind != RecordKind::kChunkIndex) break;
    if (is_behind_damage && !kept.IsEmpty() && !HasKept(log, reader, index, kept))
      continue;  // the index belongs to another chunk
    has_index = true;
    const std::optional<int> topic = log.topics.TopicOf(index.channel);
    if (topic && (*topic < 0 || !wanted[static_cast<std::size_t>(*topic)])) continue;
    LostRange& loss = losses[topic.value_or(kUndefined)];
    log.format->ReadIndex(reader, index, [&](const ChunkIndexEntry& entry) {
      if (kept.Contains(index.channel, entry.time)) return;
      ++loss.num_messages;
      loss.time.Include(entry.time);
    });
  }
  if (!has_index || !kept.IsComplete()) {
    AddLoss(damage, {problem, "", chunk.span, 0});
    return;
  }
  for (auto& [topic, loss] : losses) {
    if (loss.num_messages == 0) continue;
    loss.what = problem;
    if (topic != kUndefined) loss.topic = log.topics.topics[static_cast<std::size_t>(topic)].topic;
    AddLoss(damage, loss);
  }
}

}  // namespace parkade
