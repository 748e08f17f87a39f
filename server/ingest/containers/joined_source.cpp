#include "server/ingest/containers/joined_source.h"

#include <algorithm>
#include <map>
#include <queue>
#include <tuple>

#include "server/ingest/containers/damage.h"

namespace parkade {
namespace {

struct Part {
  std::unique_ptr<MessageSource> source;
  std::vector<int> joined_topics;  ///< by the part's own topic
  std::optional<Timestamp> begin;  ///< of its first message
};

void Append(DamageReport& all, const DamageReport& more) {
  const std::uint64_t num_lost = all.num_lost_messages + more.num_lost_messages;
  for (const LostRange& range : more.ranges) AddLoss(all, range);
  all.num_lost_messages = num_lost;
  all.is_truncated |= more.is_truncated;
}

class JoinedStream : public MessageStream {
 public:
  JoinedStream(std::shared_ptr<const std::vector<Part>> parts, const DamageReport& missing,
               std::vector<bool> wanted)
      : parts_(std::move(parts)),
        wanted_(std::move(wanted)),
        finished_(missing),
        streams_(parts_->size()) {}

  std::optional<RawMessage> Next() override {
    while (next_part_ < parts_->size() && IsNextPartDue()) OpenNextPart();
    if (heads_.empty()) return std::nullopt;
    // std::priority_queue gives no way to move its top out.
    Head head = std::move(const_cast<Head&>(heads_.top()));
    heads_.pop();
    Advance(head.part);
    return std::move(head.message);
  }

  const DamageReport& damage() const override {
    damage_ = finished_;
    for (const auto& stream : streams_)
      if (stream) Append(damage_, stream->damage());
    return damage_;
  }

 private:
  struct Head {
    RawMessage message;
    std::size_t part = 0;
    bool operator>(const Head& other) const {
      return std::pair(message.log_time, part) > std::pair(other.message.log_time, other.part);
    }
  };

  bool IsNextPartDue() const {
    constexpr std::size_t kMaxOpen = 16;
    if (heads_.empty()) return true;
    const std::optional<Timestamp>& begin = (*parts_)[next_part_].begin;
    return heads_.size() < kMaxOpen && (!begin || *begin <= heads_.top().message.log_time);
  }

  void OpenNextPart() {
    const Part& part = (*parts_)[next_part_];
    std::vector<bool> wanted;
    for (const int topic : part.joined_topics)
      wanted.push_back(wanted_[static_cast<std::size_t>(topic)]);
    streams_[next_part_] = part.source->Read(wanted);
    Advance(next_part_++);
  }

  void Advance(std::size_t part) {
    std::optional<RawMessage> message = streams_[part]->Next();
    if (!message) {
      Append(finished_, streams_[part]->damage());
      streams_[part].reset();
      return;
    }
    message->topic = (*parts_)[part].joined_topics[static_cast<std::size_t>(message->topic)];
    message->place.part = part;
    heads_.push({std::move(*message), part});
  }

  std::shared_ptr<const std::vector<Part>> parts_;
  std::vector<bool> wanted_;
  DamageReport finished_;  ///< of parts that came to their end
  mutable DamageReport damage_;
  std::vector<std::unique_ptr<MessageStream>> streams_;  ///< null: not open, or at its end
  std::size_t next_part_ = 0;
  std::priority_queue<Head, std::vector<Head>, std::greater<>> heads_;
};

class JoinedSource : public MessageSource {
 public:
  JoinedSource(std::vector<std::unique_ptr<MessageSource>> sources, const DamageReport& missing)
      : missing_(missing) {
    format_ = sources.front()->format();
    std::map<std::tuple<std::string, std::string, MessageEncoding>, int> known;
    auto parts = std::make_shared<std::vector<Part>>();
    for (std::unique_ptr<MessageSource>& source : sources) {
      Part part;
      for (const TopicInfo& topic : source->topics()) {
        const auto [entry, is_new] = known.try_emplace({topic.topic, topic.type, topic.encoding},
                                                       static_cast<int>(topics_.size()));
        part.joined_topics.push_back(entry->second);
        if (is_new) {
          topics_.push_back(topic);
        } else {
          topics_[static_cast<std::size_t>(entry->second)].num_messages += topic.num_messages;
        }
      }
      const auto first = source->Read(std::vector<bool>(source->topics().size(), true))->Next();
      if (first) part.begin = first->log_time;
      part.source = std::move(source);
      parts->push_back(std::move(part));
    }
    std::stable_sort(parts->begin(), parts->end(),
                     [](const Part& a, const Part& b) { return a.begin < b.begin; });
    parts_ = std::move(parts);
  }

  const std::vector<TopicInfo>& topics() const override { return topics_; }
  std::string format() const override { return format_; }
  std::unique_ptr<MessageStream> Read(const std::vector<bool>& wanted) const override {
    return std::make_unique<JoinedStream>(parts_, missing_, wanted);
  }
  std::optional<RawMessage> ReadAt(int topic, const MessagePlace& place) const override {
    if (place.part >= parts_->size()) return std::nullopt;
    const Part& part = (*parts_)[place.part];
    const auto own = std::find(part.joined_topics.begin(), part.joined_topics.end(), topic);
    if (own == part.joined_topics.end()) return std::nullopt;
    std::optional<RawMessage> message =
        part.source->ReadAt(static_cast<int>(own - part.joined_topics.begin()), place);
    if (message) message->topic = topic;
    return message;
  }

 private:
  std::shared_ptr<const std::vector<Part>> parts_;
  std::vector<TopicInfo> topics_;
  std::string format_;
  DamageReport missing_;
};

}  // namespace

std::unique_ptr<MessageSource> JoinSources(std::vector<std::unique_ptr<MessageSource>> parts,
                                           const DamageReport& missing) {
  if (parts.size() == 1 && missing.IsClean()) return std::move(parts.front());
  return std::make_unique<JoinedSource>(std::move(parts), missing);
}

}  // namespace parkade
