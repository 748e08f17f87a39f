#include "server/ingest/chunk_loss.h"

#include <algorithm>
#include <map>

#include "server/ingest/damage.h"

namespace parkade {

void AddChunkLoss(const ScannedLog& log, const LogRecord& chunk, const std::string& problem, const KeptMessages& kept,
                  const std::vector<bool>& wanted, DamageReport& damage) {
  FileReader reader(*log.file, log.format->EndOfRecords(*log.file));
  std::map<int, LostRange> losses;
  bool has_index = false;
  for (std::uint64_t offset = chunk.end; offset < reader.size();) {
    const std::optional<LogRecord> index = log.format->Parse(reader, offset);
    if (!index || index->kind != RecordKind::kChunkIndex) break;
    offset = index->end;
    has_index = true;
    const int topic = log.topics.TopicOf(index->channel).value_or(-1);
    if (topic < 0 || !wanted[static_cast<std::size_t>(topic)]) continue;
    LostRange& loss = losses[topic];
    log.format->ReadIndex(reader, *index, [&](const ChunkIndexEntry& entry) {
      if (std::binary_search(kept.offsets.begin(), kept.offsets.end(), entry.offset)) return;
      ++loss.num_messages;
      loss.time.Include(entry.time);
    });
  }
  for (auto& [topic, loss] : losses) {
    if (loss.num_messages == 0) continue;
    loss.what = problem;
    loss.topic = log.topics.topics[static_cast<std::size_t>(topic)].topic;
    AddLoss(damage, loss);
  }
  if (!has_index) AddLoss(damage, {problem, "", chunk.span, 0});
}

}  // namespace parkade
