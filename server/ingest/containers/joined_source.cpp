#include "server/ingest/containers/joined_source.h"

#include <algorithm>
#include <map>
#include <queue>
#include <set>
#include <tuple>

#include "server/ingest/containers/damage.h"

namespace parkade {
namespace {

struct Part {
  std::unique_ptr<MessageSource> source;
  std::vector<int> joined_topics;  ///< by the part's own topic
  std::optional<Timestamp> begin;  ///< of its first message
};

struct Parts {
  std::vector<Part> parts;
  bool are_merged = true;  ///< by time; false: one is read after the other
};

/// Whether two files hold, mostly, the same topics.
bool AreAlike(const Part& a, const Part& b) {
  const auto is_shared = [&](int topic) {
    return std::find(b.joined_topics.begin(), b.joined_topics.end(), topic) !=
           b.joined_topics.end();
  };
  const auto num_shared = std::count_if(a.joined_topics.begin(), a.joined_topics.end(), is_shared);
  return 2 * static_cast<std::size_t>(num_shared) >
         std::max(a.joined_topics.size(), b.joined_topics.size());
}

/// A pass over those of a file's topics that another has too.
std::unique_ptr<MessageStream> ReadShared(const Part& part, const Part& other) {
  std::vector<bool> wanted;
  for (const int topic : part.joined_topics)
    wanted.push_back(std::find(other.joined_topics.begin(), other.joined_topics.end(), topic) !=
                     other.joined_topics.end());
  return part.source->Read(wanted);
}

/// Whether one of the first messages of a file is in another, too, as where two recorders ran.
bool RepeatsFirstOf(const Part& part, const Part& other) {
  constexpr std::size_t kNumFirst = 50;
  const auto text_of = [](const RawMessage& message) {
    return std::string(message.data.begin(), message.data.end());
  };
  std::set<std::string> first;
  const auto stream = ReadShared(part, other);
  while (const std::optional<RawMessage> message = stream->Next()) {
    first.insert(text_of(*message));
    if (first.size() == kNumFirst) break;
  }
  const auto all = ReadShared(other, part);
  while (const std::optional<RawMessage> message = all->Next())
    if (first.contains(text_of(*message))) return true;
  return false;
}

/// Whether the recorder's clock was set back from file to file, or within one: the same topics were
/// then recorded twice at a time, but other messages.
bool WereSetBack(const std::vector<Part>& parts) {
  constexpr double kMinOverlap = 1;  // [s]
  for (std::size_t k = 1; k < parts.size(); ++k) {
    for (std::size_t i = 0; i < k; ++i) {
      const TimeSpan a = parts[i].source->span(), b = parts[k].source->span();
      if (a.IsEmpty() || b.IsEmpty() || !AreAlike(parts[i], parts[k])) continue;
      const double overlap = std::min(a.end, b.end) - std::max(a.begin, b.begin);
      if (overlap > kMinOverlap && !RepeatsFirstOf(parts[k], parts[i]) &&
          !RepeatsFirstOf(parts[i], parts[k]))
        return true;
    }
  }
  return false;
}

void Append(DamageReport& all, const DamageReport& more) {
  const std::uint64_t num_lost = all.num_lost_messages + more.num_lost_messages;
  for (const LostRange& range : more.ranges) AddLoss(all, range);
  all.num_lost_messages = num_lost;
  all.is_truncated |= more.is_truncated;
}

class JoinedStream : public MessageStream {
 public:
  JoinedStream(std::shared_ptr<const Parts> parts, const DamageReport& missing,
               std::vector<bool> wanted)
      : parts_(std::move(parts)),
        wanted_(std::move(wanted)),
        finished_(missing),
        streams_(parts_->parts.size()) {}

  std::optional<RawMessage> Next() override {
    while (next_part_ < parts_->parts.size() && IsNextPartDue()) OpenNextPart();
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
    const std::optional<Timestamp> begin = parts_->parts[next_part_].begin;
    return parts_->are_merged && heads_.size() < kMaxOpen &&
           (!begin || *begin <= heads_.top().message.log_time);
  }

  void OpenNextPart() {
    const Part& part = parts_->parts[next_part_];
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
    message->topic = parts_->parts[part].joined_topics[static_cast<std::size_t>(message->topic)];
    message->place.part = part;
    heads_.push({std::move(*message), part});
  }

  std::shared_ptr<const Parts> parts_;
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
    auto joined = std::make_shared<Parts>();
    std::vector<Part>& parts = joined->parts;
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
      parts.push_back(std::move(part));
    }
    joined->are_merged = !WereSetBack(parts);
    if (joined->are_merged)
      std::stable_sort(parts.begin(), parts.end(),
                       [](const Part& a, const Part& b) { return a.begin < b.begin; });
    parts_ = std::move(joined);
  }

  const std::vector<TopicInfo>& topics() const override { return topics_; }
  std::string format() const override { return format_; }
  std::unique_ptr<MessageStream> Read(const std::vector<bool>& wanted) const override {
    return std::make_unique<JoinedStream>(parts_, missing_, wanted);
  }
  std::optional<RawMessage> ReadAt(int topic, const MessagePlace& place) const override {
    if (place.part >= parts_->parts.size()) return std::nullopt;
    const Part& part = parts_->parts[place.part];
    const auto own = std::find(part.joined_topics.begin(), part.joined_topics.end(), topic);
    if (own == part.joined_topics.end()) return std::nullopt;
    std::optional<RawMessage> message =
        part.source->ReadAt(static_cast<int>(own - part.joined_topics.begin()), place);
    if (message) message->topic = topic;
    return message;
  }

 private:
  std::shared_ptr<const Parts> parts_;
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
