#include "server/ingest/containers/chunked_log_source.h"

#include <algorithm>
#include <numeric>
#include <queue>

#include "server/ingest/containers/damage.h"
#include "server/ingest/containers/log_scanner.h"
#include "server/ingest/containers/message_packing.h"
#include "server/ingest/containers/segment_loader.h"

namespace parkade {
namespace {

constexpr std::uint64_t kMaxOpenSize = std::uint64_t{48} << 20;

/// In which order the segments of a log are opened.
struct ReadingPlan {
  std::vector<std::uint32_t> order;
  bool is_merged = true;  ///< by time; false: one after the other, because too much overlaps
  SegmentOrder within = SegmentOrder::kLogTime;
};

ReadingPlan PlanReading(const ScannedLog& log) {
  const std::vector<LogSegment>& segments = log.segments;
  ReadingPlan plan;
  plan.order.resize(segments.size());
  std::iota(plan.order.begin(), plan.order.end(), 0u);
  const std::vector<std::uint32_t> file_order = plan.order;
  if (log.is_set_back) return {file_order, false, SegmentOrder::kFile};
  std::stable_sort(plan.order.begin(), plan.order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return segments[a].time.begin < segments[b].time.begin;
  });
  using End = std::pair<Timestamp, std::uint64_t>;
  std::priority_queue<End, std::vector<End>, std::greater<>> open;
  std::uint64_t open_size = 0;
  for (const std::uint32_t i : plan.order) {
    while (!open.empty() && open.top().first < segments[i].time.begin) {
      open_size -= open.top().second;
      open.pop();
    }
    open.emplace(segments[i].time.end, segments[i].held_size);
    open_size += segments[i].held_size;
    if (open.size() > 1 && open_size > kMaxOpenSize)
      return {file_order, false, SegmentOrder::kLogTime};
  }
  return plan;
}

class SegmentStream : public MessageStream {
 public:
  SegmentStream(std::shared_ptr<const ScannedLog> log, std::shared_ptr<const ReadingPlan> plan,
                std::vector<bool> wanted)
      : log_(std::move(log)), plan_(std::move(plan)), wanted_(std::move(wanted)) {
    damage_ = OfWanted(log_->damage, log_->topics.topics, wanted_);
  }

  std::optional<RawMessage> Next() override {
    while (true) {
      while (next_segment_ < plan_->order.size() && IsNextSegmentDue()) OpenNextSegment();
      if (open_.empty()) return std::nullopt;
      const Open open = open_.top();
      open_.pop();
      RawMessage message = open.cursor->Take();
      Push(open.rank, std::shared_ptr<SegmentCursor>(open.cursor));
      const TopicInfo& topic = log_->topics.topics[static_cast<std::size_t>(message.topic)];
      if (UnpackMessage(topic, message, damage_)) return message;
    }
  }

  const DamageReport& damage() const override { return damage_; }

 private:
  struct Open {
    Timestamp time;
    std::uint32_t rank = 0;
    std::shared_ptr<SegmentCursor> cursor;
    bool operator>(const Open& other) const {
      return std::pair(time, rank) > std::pair(other.time, other.rank);
    }
  };

  bool IsNextSegmentDue() const {
    if (open_.empty()) return true;
    return plan_->is_merged &&
           log_->segments[plan_->order[next_segment_]].time.begin <= open_.top().time;
  }

  void OpenNextSegment() {
    const LogSegment& segment = log_->segments[plan_->order[next_segment_]];
    Push(next_segment_++, OpenSegment(*log_, segment, wanted_, plan_->within, damage_));
  }

  void Push(std::uint32_t rank, std::shared_ptr<SegmentCursor> cursor) {
    const std::optional<Timestamp> time = cursor->NextTime();
    if (time) open_.push({*time, rank, std::move(cursor)});
  }

  std::shared_ptr<const ScannedLog> log_;
  std::shared_ptr<const ReadingPlan> plan_;
  std::vector<bool> wanted_;
  DamageReport damage_;
  std::uint32_t next_segment_ = 0;
  std::priority_queue<Open, std::vector<Open>, std::greater<>> open_;
};

class ChunkedLogSource : public MessageSource {
 public:
  ChunkedLogSource(std::shared_ptr<const InputFile> file, const LogFormat& format)
      : log_(std::make_shared<ScannedLog>(ScanLog(std::move(file), format))),
        plan_(std::make_shared<ReadingPlan>(PlanReading(*log_))) {}

  const std::vector<TopicInfo>& topics() const override { return log_->topics.topics; }
  std::string format() const override { return log_->format->name(); }
  std::unique_ptr<MessageStream> Read(const std::vector<bool>& wanted) const override {
    return std::make_unique<SegmentStream>(log_, plan_, wanted);
  }
  std::optional<RawMessage> ReadAt(int topic, const MessagePlace& place) const override {
    std::optional<RawMessage> message = ReadMessageAt(*log_, place);
    DamageReport damage;
    if (!message || message->topic != topic ||
        !UnpackMessage(topics()[static_cast<std::size_t>(topic)], *message, damage))
      return std::nullopt;
    message->place = place;
    return message;
  }
  TimeSpan span() const override {
    TimeSpan span;
    for (const LogSegment& segment : log_->segments) {
      if (segment.time.IsEmpty()) continue;
      span.Include(segment.time.begin);
      span.Include(segment.time.end);
    }
    return span;
  }

 private:
  std::shared_ptr<const ScannedLog> log_;
  std::shared_ptr<const ReadingPlan> plan_;
};

}  // namespace

std::unique_ptr<MessageSource> OpenChunkedLog(std::shared_ptr<const InputFile> file,
                                              const LogFormat& format) {
  return std::make_unique<ChunkedLogSource>(std::move(file), format);
}

}  // namespace parkade
