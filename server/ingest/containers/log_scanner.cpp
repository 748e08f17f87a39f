#include "server/ingest/containers/log_scanner.h"

#include <algorithm>
#include <set>

#include "server/ingest/containers/channel_clocks.h"
#include "server/ingest/containers/chunk_content.h"
#include "server/ingest/containers/damage.h"
#include "server/ingest/containers/record_walker.h"
#include "server/ingest/containers/segment_list.h"

namespace parkade {
namespace {

class LogScanner {
 public:
  LogScanner(std::shared_ptr<const InputFile> file, const LogFormat& format)
      : format_(&format), reader_(*file, format.EndOfRecords(*file)) {
    log_.file = std::move(file);
    log_.format = &format;
  }

  ScannedLog Scan();

 private:
  /// A chunk whose index records are still coming.
  struct OpenedChunk {
    LogRecord record;
    std::map<std::uint32_t, MessageCount> index;  ///< by channel
    bool has_damage_behind = false;
    std::vector<LogRecord>
        doubtful_indexes;  ///< behind the damage: of this chunk, or of one that was lost
  };
  struct ChunkMessages {
    std::map<std::uint32_t, MessageCount> by_channel;
    std::set<std::pair<std::uint32_t, Timestamp>>
        stamps;  ///< only where doubtful indexes need them
    TimeSpan time;
  };

  void OnRecord(const LogRecord& record);
  void OnDamage(std::uint64_t begin, const RecordWalker::Step& step);
  void OnIndex(const LogRecord& record);
  void OnMessage(const LogRecord& record);
  void CloseChunk();
  bool MustUnpack(const OpenedChunk& chunk) const;
  bool IsIndexOf(const LogRecord& index, const ChunkMessages& messages);
  ChunkMessages Unpack(const OpenedChunk& chunk);
  void GuessDefinitions(const LogRecord& chunk);
  void AddOrphan(const LogRecord& index);
  MessageCount CountEntries(const LogRecord& index);

  const LogFormat* format_;
  FileReader reader_;
  ScannedLog log_;
  ChannelTable channels_;
  ChannelTable guessed_channels_;  ///< from damaged chunks
  LogSummary summary_;
  bool has_all_channels_ = false;
  std::map<std::uint32_t, std::uint64_t> num_messages_;
  std::optional<OpenedChunk> chunk_;
  std::map<std::uint32_t, std::uint64_t>
      num_salvaged_;  ///< messages outside chunks since the last damage
  ChannelLosses losses_;
  ChannelClocks clocks_;
  SegmentList segments_;
};

ScannedLog LogScanner::Scan() {
  summary_ = format_->ReadSummary(*log_.file, channels_);
  has_all_channels_ = summary_.num_channels && *summary_.num_channels <= channels_.num_channels();
  log_.damage.is_truncated = !summary_.is_closed;
  if (!summary_.problem.empty()) AddLoss(log_.damage, {summary_.problem, "", {}, 0});
  RecordWalker walker(*format_, reader_);
  for (std::uint64_t offset = format_->FirstRecord(); offset < reader_.size();) {
    const RecordWalker::Step step = walker.At(offset);
    if (step.is_damaged) {
      OnDamage(offset, step);
    } else {
      OnRecord(*step.record);
    }
    offset = step.next;
  }
  CloseChunk();
  // A chunk is complete only after what lies open behind it.
  log_.segments = segments_.TakeSorted();
  channels_.AddMissing(guessed_channels_);
  const bool knows_counts = has_all_channels_ && !summary_.num_messages.empty();
  log_.topics = channels_.MakeTopics(knows_counts ? summary_.num_messages : num_messages_);
  losses_.AddTo(log_.damage, log_.topics);
  log_.is_set_back = clocks_.WereSetBack();
  return std::move(log_);
}

void LogScanner::OnRecord(const LogRecord& record) {
  if (record.kind == RecordKind::kChunkIndex) return OnIndex(record);
  // Messages of a damaged chunk may lie open between it and its index.
  const bool may_be_of_chunk =
      record.kind == RecordKind::kMessage || record.kind == RecordKind::kDefinition;
  if (!may_be_of_chunk || (chunk_ && !chunk_->has_damage_behind)) CloseChunk();
  if (record.kind == RecordKind::kDefinition) format_->Learn(reader_, record, channels_);
  if (record.kind == RecordKind::kMessage) OnMessage(record);
  if (record.kind == RecordKind::kChunk) {
    num_salvaged_.clear();
    log_.damage.is_truncated |= record.is_at_end;
    chunk_ = OpenedChunk{record, {}, false, {}};
  }
}

void LogScanner::OnDamage(std::uint64_t begin, const RecordWalker::Step& step) {
  const std::string size = std::to_string(step.next - begin);
  ChannelLoss loss{size + " bytes at byte " + std::to_string(begin) + " are damaged", {}, {}};
  if (step.next == reader_.size()) {
    log_.damage.is_truncated = true;
    if (step.record && step.record->kind == RecordKind::kMessage) {
      loss.what = "the file ends inside of a message";
      loss.channel = step.record->channel;
      loss.lost = {1, {step.record->time, step.record->time}};
    }
  }
  losses_.Add(std::move(loss));
  num_salvaged_.clear();
  segments_.BeginNew();
  if (chunk_) chunk_->has_damage_behind = true;
}

void LogScanner::OnIndex(const LogRecord& record) {
  if (!chunk_) return AddOrphan(record);
  if (chunk_->has_damage_behind) {
    constexpr std::size_t kMaxDoubtful = 65536;
    if (chunk_->doubtful_indexes.size() < kMaxDoubtful) chunk_->doubtful_indexes.push_back(record);
    return;
  }
  const MessageCount counted = CountEntries(record);
  MessageCount& known = chunk_->index[record.channel];
  known.num_messages += counted.num_messages;
  if (counted.time.IsEmpty()) return;
  known.time.Include(counted.time.begin);
  known.time.Include(counted.time.end);
}

void LogScanner::OnMessage(const LogRecord& record) {
  if (record.data_size > kMaxMessageSize) {
    losses_.Add(
        {"a message is larger than 64 MiB", record.channel, {1, {record.time, record.time}}});
    segments_.BeginNew();
    return;
  }
  ++num_messages_[record.channel];
  ++num_salvaged_[record.channel];
  clocks_.Add(record.channel, record.time);
  segments_.Add(record, record.end - record.begin, {record.time, record.time});
}

void LogScanner::CloseChunk() {
  if (!chunk_) return;
  const OpenedChunk chunk = std::move(*chunk_);
  chunk_.reset();
  std::map<std::uint32_t, MessageCount> by_channel = chunk.index;
  TimeSpan time = chunk.record.span;
  if (MustUnpack(chunk)) {
    const ChunkMessages messages = Unpack(chunk);
    if (!messages.time.IsEmpty()) {
      time = messages.time;
      by_channel = messages.by_channel;
      for (const LogRecord& index : chunk.doubtful_indexes)
        if (!IsIndexOf(index, messages)) AddOrphan(index);
    }
  }
  const bool is_time_open = time.IsEmpty();
  for (const auto& [channel, counted] : by_channel) {
    num_messages_[channel] += counted.num_messages;
    if (!is_time_open || counted.time.IsEmpty()) continue;
    time.Include(counted.time.begin);
    time.Include(counted.time.end);
  }
  // The time of a chunk that cannot be unpacked and has no index: that of the log before it.
  if (time.IsEmpty() && segments_.last())
    time = {segments_.last()->time.end, segments_.last()->time.end};
  segments_.Add(chunk.record, std::min(chunk.record.unpacked_size, kMaxHeldChunk), time);
}

bool LogScanner::MustUnpack(const OpenedChunk& chunk) const {
  if (chunk.record.is_at_end || chunk.has_damage_behind) return true;
  const bool has_new_channel =
      std::any_of(chunk.index.begin(), chunk.index.end(),
                  [&](const auto& entry) { return !channels_.HasChannel(entry.first); });
  if (!has_all_channels_ && (has_new_channel || chunk.index.empty())) return true;
  const TimeSpan& claimed = chunk.record.span;
  if (claimed.IsEmpty()) return chunk.index.empty();
  // A jump is rare, and a damaged time would move the whole chunk to a wrong time.
  constexpr double kLargeJump = 3600;  // [s]
  if (!segments_.last()) return claimed.Seconds() > kLargeJump;
  const Timestamp before = segments_.last()->time.end;
  return std::abs(claimed.begin - before) > kLargeJump ||
         std::abs(claimed.end - before) > kLargeJump;
}

/// True when one of the index's messages is in the chunk: its other messages may be damaged.
bool LogScanner::IsIndexOf(const LogRecord& index, const ChunkMessages& messages) {
  bool is_index = false;
  format_->ReadIndex(reader_, index, [&](const ChunkIndexEntry& entry) {
    is_index |= messages.stamps.contains({index.channel, entry.time});
  });
  return is_index;
}

LogScanner::ChunkMessages LogScanner::Unpack(const OpenedChunk& chunk) {
  ChunkMessages messages;
  const ChunkContent content = OpenChunk(*log_.file, chunk.record);
  if (!content.reader) {
    GuessDefinitions(chunk.record);
    return messages;
  }
  RecordWalker walker(*format_, *content.reader);
  for (std::uint64_t offset = 0; offset < content.reader->size();) {
    content.reader->Release(offset);
    const RecordWalker::Step step = walker.At(offset);
    offset = step.next;
    if (step.is_damaged) continue;
    if (step.record->kind == RecordKind::kDefinition)
      format_->Learn(*content.reader, *step.record, channels_);
    if (step.record->kind != RecordKind::kMessage) continue;
    MessageCount& counted = messages.by_channel[step.record->channel];
    ++counted.num_messages;
    if (chunk.index.empty()) clocks_.Add(step.record->channel, step.record->time);
    counted.time.Include(step.record->time);
    messages.time.Include(step.record->time);
    if (!chunk.doubtful_indexes.empty())
      messages.stamps.insert({step.record->channel, step.record->time});
  }
  return messages;
}

/// Some writers define a channel only once. Where that one is in a damaged chunk, anything that
/// still looks like a definition is better than nothing: without it every message of the channel
/// would be lost.
void LogScanner::GuessDefinitions(const LogRecord& chunk) {
  const std::vector<std::uint8_t> bytes = UnpackDamagedChunk(*log_.file, chunk);
  MemoryReader reader(bytes);
  RecordWalker walker(*format_, reader);
  for (std::uint64_t offset = 0; offset < reader.size();) {
    const RecordWalker::Step step = walker.At(offset);
    offset = step.next;
    const bool is_definition = !step.is_damaged && step.record->kind == RecordKind::kDefinition;
    if (is_definition) format_->Learn(reader, *step.record, guessed_channels_);
  }
}

void LogScanner::AddOrphan(const LogRecord& index) {
  MessageCount counted = CountEntries(index);
  std::uint64_t& num_salvaged = num_salvaged_[index.channel];
  const std::uint64_t num_found = std::min(num_salvaged, counted.num_messages);
  num_salvaged -= num_found;
  counted.num_messages -= num_found;
  if (counted.num_messages == 0) return;
  losses_.Add({"the chunk before byte " + std::to_string(index.begin) + " is damaged",
               index.channel, counted});
}

MessageCount LogScanner::CountEntries(const LogRecord& index) {
  MessageCount counted;
  format_->ReadIndex(reader_, index, [&](const ChunkIndexEntry& entry) {
    ++counted.num_messages;
    clocks_.Add(index.channel, entry.time);
    counted.time.Include(entry.time);
  });
  return counted;
}

}  // namespace

ScannedLog ScanLog(std::shared_ptr<const InputFile> file, const LogFormat& format) {
  return LogScanner(std::move(file), format).Scan();
}

}  // namespace parkade
