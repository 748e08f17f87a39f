#include "server/ingest/containers/segment_loader.h"

#include <algorithm>

#include "server/ingest/containers/chunk_content.h"
#include "server/ingest/containers/chunk_loss.h"
#include "server/ingest/containers/damage.h"
#include "server/ingest/containers/record_walker.h"

namespace parkade {
namespace {

/// Decides over the records of one chunk, in order.
class ChunkFilter {
 public:
  ChunkFilter(const ScannedLog& log, const std::vector<bool>& wanted)
      : log_(&log), wanted_(&wanted) {}

  /// The topic of a wanted message; nothing for any other record.
  std::optional<int> Accept(const RecordWalker::Step& step) {
    if (step.is_damaged) {
      num_damaged_bytes_ += step.next - (step.record ? step.record->begin : last_end_);
    }
    last_end_ = step.next;
    if (step.is_damaged || step.record->kind != RecordKind::kMessage) return std::nullopt;
    const std::optional<int> topic = log_->topics.TopicOf(step.record->channel);
    if (!topic || step.record->data_size > kMaxMessageSize) {
      ++num_unusable_;
      return std::nullopt;
    }
    kept.Add(step.record->channel, step.record->time);
    if (*topic < 0 || !(*wanted_)[static_cast<std::size_t>(*topic)]) return std::nullopt;
    return topic;
  }

  /// One sentence, or empty when every record was good.
  std::string Problem(const LogRecord& chunk) const {
    if (num_damaged_bytes_ + num_unusable_ == 0) return "";
    return "the chunk at byte " + std::to_string(chunk.begin) + " has " +
           std::to_string(num_damaged_bytes_) + " damaged bytes and " +
           std::to_string(num_unusable_) + " unusable messages";
  }

  KeptMessages kept;

 private:
  const ScannedLog* log_;
  const std::vector<bool>* wanted_;
  std::uint64_t last_end_ = 0;
  std::uint64_t num_damaged_bytes_ = 0, num_unusable_ = 0;
};

/// All messages of a segment in memory, sorted.
class LoadedSegment : public SegmentCursor {
 public:
  LoadedSegment(const ScannedLog& log, const LogSegment& segment, const std::vector<bool>& wanted,
                SegmentOrder order, DamageReport& damage) {
    FileReader reader(*log.file, segment.end);
    RecordWalker walker(*log.format, reader);
    for (std::uint64_t offset = segment.begin; offset < segment.end;) {
      const RecordWalker::Step step = walker.At(offset);
      offset = step.next;
      if (step.is_damaged) continue;  // the scan has reported it
      if (step.record->kind == RecordKind::kChunk) {
        LogRecord chunk = *step.record;
        chunk.is_at_end = segment.is_at_end;  // at the end of the log, not of this stretch of it
        AddChunk(log, chunk, wanted, damage);
      }
      if (step.record->kind == RecordKind::kMessage) AddLoose(log, *step.record, wanted, damage);
    }
    if (order == SegmentOrder::kFile) return;
    std::stable_sort(messages_.begin(), messages_.end(),
                     [](const Message& a, const Message& b) { return a.time < b.time; });
  }

  std::optional<Timestamp> NextTime() override {
    return next_ < messages_.size() ? std::optional(messages_[next_].time) : std::nullopt;
  }

  RawMessage Take() override {
    const Message& message = messages_[next_++];
    const auto begin = bytes_.begin() + static_cast<std::ptrdiff_t>(message.begin);
    return {message.topic,
            message.time,
            {begin, begin + static_cast<std::ptrdiff_t>(message.size)},
            message.place};
  }

 private:
  struct Message {
    Timestamp time;
    int topic = 0;
    std::size_t begin = 0, size = 0;  ///< in bytes_
    MessagePlace place;
  };

  void AddChunk(const ScannedLog& log, const LogRecord& chunk, const std::vector<bool>& wanted,
                DamageReport& damage) {
    ChunkContent content = OpenChunk(*log.file, chunk);
    ChunkFilter filter(log, wanted);
    if (content.reader) {
      RecordWalker walker(*log.format, *content.reader);
      for (std::uint64_t offset = 0; offset < content.reader->size();) {
        const RecordWalker::Step step = walker.At(offset);
        offset = step.next;
        const std::optional<int> topic = filter.Accept(step);
        if (!topic) continue;
        messages_.push_back({step.record->time,
                             *topic,
                             bytes_.size() + static_cast<std::size_t>(step.record->data_begin),
                             static_cast<std::size_t>(step.record->data_size),
                             {chunk.begin, step.record->begin}});
      }
    }
    const std::string problem = content.problem.empty() ? filter.Problem(chunk) : content.problem;
    if (!problem.empty()) AddChunkLoss(log, chunk, problem, filter.kept, wanted, damage);
    if (bytes_.empty()) {
      bytes_ = std::move(content.bytes);
    } else {
      bytes_.insert(bytes_.end(), content.bytes.begin(), content.bytes.end());
    }
  }

  void AddLoose(const ScannedLog& log, const LogRecord& record, const std::vector<bool>& wanted,
                DamageReport& damage) {
    const std::optional<int> topic = log.topics.TopicOf(record.channel);
    if (!topic) {
      AddLoss(damage, {"a message is of a topic that the log does not define",
                       "",
                       {record.time, record.time},
                       1});
      return;
    }
    if (*topic < 0 || !wanted[static_cast<std::size_t>(*topic)]) return;
    const std::size_t begin = bytes_.size();
    bytes_.resize(begin + static_cast<std::size_t>(record.data_size));
    const std::size_t size = log.file->ReadAt(record.data_begin, std::span(bytes_).subspan(begin));
    messages_.push_back({record.time, *topic, begin, size, {record.begin, 0}});
  }

  std::vector<std::uint8_t> bytes_;
  std::vector<Message> messages_;
  std::size_t next_ = 0;
};

/// A chunk too large to be held: its messages come in the order of the file.
class StreamedChunk : public SegmentCursor {
 public:
  StreamedChunk(const ScannedLog& log, const LogSegment& segment, const std::vector<bool>& wanted,
                DamageReport& damage)
      : log_(&log), wanted_(&wanted), damage_(&damage), filter_(log, wanted) {
    FileReader reader(*log.file, segment.end);
    const RecordWalker::Step step = RecordWalker(*log.format, reader).At(segment.begin);
    if (step.is_damaged || step.record->kind != RecordKind::kChunk) return;
    chunk_ = *step.record;
    chunk_.is_at_end = segment.is_at_end;
    content_ = OpenChunk(*log.file, chunk_);
    if (content_.reader) walker_.emplace(*log.format, *content_.reader);
    Advance();
  }

  std::optional<Timestamp> NextTime() override {
    return next_ ? std::optional(next_->log_time) : std::nullopt;
  }

  RawMessage Take() override {
    RawMessage message = std::move(*next_);
    Advance();
    return message;
  }

 private:
  void Advance() {
    next_.reset();
    while (content_.reader && offset_ < content_.reader->size()) {
      content_.reader->Release(offset_);
      const RecordWalker::Step step = walker_->At(offset_);
      offset_ = step.next;
      const std::optional<int> topic = filter_.Accept(step);
      if (!topic) continue;
      const LogRecord& record = *step.record;
      const std::span<const std::uint8_t> data =
          content_.reader->Fetch(record.data_begin, static_cast<std::size_t>(record.data_size));
      next_ =
          RawMessage{*topic, record.time, {data.begin(), data.end()}, {chunk_.begin, record.begin}};
      return;
    }
    if (is_finished_) return;
    is_finished_ = true;
    const std::string problem =
        content_.problem.empty() ? filter_.Problem(chunk_) : content_.problem;
    if (!problem.empty()) AddChunkLoss(*log_, chunk_, problem, filter_.kept, *wanted_, *damage_);
  }

  const ScannedLog* log_;
  const std::vector<bool>* wanted_;
  DamageReport* damage_;
  ChunkFilter filter_;
  LogRecord chunk_;
  ChunkContent content_;
  std::optional<RecordWalker> walker_;
  std::uint64_t offset_ = 0;
  std::optional<RawMessage> next_;
  bool is_finished_ = false;
};

/// The bytes of the message whose record begins at `offset`; nothing where there is none.
std::optional<RawMessage> ReadRecord(const ScannedLog& log, ByteReader& reader,
                                     std::uint64_t offset) {
  if (offset >= reader.size()) return std::nullopt;
  const RecordWalker::Step step = RecordWalker(*log.format, reader).At(offset);
  if (step.is_damaged || step.record->kind != RecordKind::kMessage ||
      step.record->data_size > kMaxMessageSize)
    return std::nullopt;
  const std::span<const std::uint8_t> data =
      reader.Fetch(step.record->data_begin, static_cast<std::size_t>(step.record->data_size));
  const int topic = log.topics.TopicOf(step.record->channel).value_or(-1);
  return RawMessage{topic, step.record->time, {data.begin(), data.end()}};
}

/// Lets a reader of a large chunk, which sees a window of it, pass what lies before `offset`.
void PassTo(std::uint64_t offset, ByteReader& reader) {
  constexpr std::uint64_t kStep = std::uint64_t{1} << 20;
  for (std::uint64_t at = 0; at < offset; at += kStep) {
    reader.Release(at);
    if (reader.Fetch(at, 1).empty()) return;
  }
  reader.Release(offset);
}

}  // namespace

std::optional<RawMessage> ReadMessageAt(const ScannedLog& log, const MessagePlace& place) {
  FileReader reader(*log.file, log.format->EndOfRecords(*log.file));
  if (place.record >= reader.size()) return std::nullopt;
  const RecordWalker::Step step = RecordWalker(*log.format, reader).At(place.record);
  if (step.is_damaged) return std::nullopt;
  if (step.record->kind != RecordKind::kChunk) return ReadRecord(log, reader, place.record);
  const ChunkContent content = OpenChunk(*log.file, *step.record);
  if (!content.reader) return std::nullopt;
  PassTo(place.in_chunk, *content.reader);
  return ReadRecord(log, *content.reader, place.in_chunk);
}

std::unique_ptr<SegmentCursor> OpenSegment(const ScannedLog& log, const LogSegment& segment,
                                           const std::vector<bool>& wanted, SegmentOrder order,
                                           DamageReport& damage) {
  if (segment.is_large_chunk) return std::make_unique<StreamedChunk>(log, segment, wanted, damage);
  return std::make_unique<LoadedSegment>(log, segment, wanted, order, damage);
}

}  // namespace parkade
