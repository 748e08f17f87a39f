#include "server/ingest/containers/joined_source.h"

#include <algorithm>
#include <map>
#include <queue>
#include <set>
#include <string_view>
#include <tuple>

#include "server/ingest/containers/damage.h"

namespace parkade {
namespace {

struct Part {
  std::unique_ptr<MessageSource> source;
  std::vector<int> joined_topics;  ///< by the part's own topic
  std::optional<Timestamp> begin;  ///< of its first message
  std::size_t epoch = 0;           ///< parts of one are merged by time, after those of the last
};

bool Holds(const Part& part, int topic) {
  return std::find(part.joined_topics.begin(), part.joined_topics.end(), topic) !=
         part.joined_topics.end();
}

/// Whether two files hold, mostly, the same topics.
bool AreAlike(const Part& a, const Part& b) {
  const auto num_shared = std::count_if(a.joined_topics.begin(), a.joined_topics.end(),
                                        [&](int topic) { return Holds(b, topic); });
  return 2 * static_cast<std::size_t>(num_shared) >
         std::max(a.joined_topics.size(), b.joined_topics.size());
}

using Hashes = std::set<std::size_t>;  ///< of messages

/// What a file holds in some time, by topic, of those that another has too.
std::map<int, Hashes> HashesIn(const Part& part, const Part& other, const TimeSpan& time) {
  std::vector<bool> wanted;
  for (const int topic : part.joined_topics) wanted.push_back(Holds(other, topic));
  std::map<int, Hashes> hashes;
  const auto stream = part.source->Read(wanted);
  while (const std::optional<RawMessage> message = stream->Next()) {
    const std::string_view bytes(reinterpret_cast<const char*>(message->data.data()),
                                 message->data.size());
    if (time.Contains(message->log_time))
      hashes[part.joined_topics[static_cast<std::size_t>(message->topic)]].insert(
          std::hash<std::string_view>()(bytes));
  }
  return hashes;
}

/// Whether two files that overlap in time hold other messages there, as where the recorder's clock
/// was set back between them; not the same, as where two recorders ran, nor a lone wrong time.
bool DifferIn(const TimeSpan& time, const Part& a, const Part& b) {
  constexpr std::size_t kMinMessages = 5;  // of a topic, each unlike the others
  const std::map<int, Hashes> of_a = HashesIn(a, b, time);
  std::map<int, Hashes> of_b = HashesIn(b, a, time);
  int num_other = 0, num_same = 0;  // topics
  for (const auto& [topic, hashes] : of_a) {
    const Hashes& others = of_b[topic];
    const std::size_t fewer = std::min(hashes.size(), others.size());
    if (fewer < kMinMessages) continue;
    const auto num_shared =
        std::count_if(hashes.begin(), hashes.end(),
                      [&others = others](std::size_t hash) { return others.contains(hash); });
    ++(2 * static_cast<std::size_t>(num_shared) > fewer ? num_same : num_other);
  }
  return num_other > num_same;
}

/// Whether the recorder's clock was set back from file to file of one recording, or within one.
bool WasSetBack(const std::vector<Part*>& files) {
  constexpr double kMinOverlap = 1;  // [s]
  for (std::size_t k = 1; k < files.size(); ++k)
    for (std::size_t i = 0; i < k; ++i) {
      const TimeSpan a = files[i]->source->span(), b = files[k]->source->span();
      const TimeSpan both{std::max(a.begin, b.begin), std::min(a.end, b.end)};
      if (!a.IsEmpty() && !b.IsEmpty() && both.Seconds() > kMinOverlap &&
          DifferIn(both, *files[i], *files[k]))
        return true;
    }
  return false;
}

/// Files of the same topics, as they are given.
std::vector<std::vector<Part*>> RecordingsOf(std::vector<Part>& parts) {
  std::vector<std::vector<Part*>> recordings;
  for (Part& part : parts) {
    if (!part.begin) continue;
    const auto own = std::find_if(recordings.begin(), recordings.end(),
                                  [&](const auto& files) { return AreAlike(*files[0], part); });
    if (own == recordings.end())
      recordings.push_back({&part});
    else
      own->push_back(&part);
  }
  return recordings;
}

/// Where clocks were set back, the first files of all recordings come first, then the second ones.
/// Recordings of which not all were split so stay merged.
void FindEpochs(std::vector<Part>& parts) {
  const std::vector<std::vector<Part*>> recordings = RecordingsOf(parts);
  if (recordings.empty() ||
      !std::all_of(recordings.begin(), recordings.end(), [&](const std::vector<Part*>& files) {
        return files.size() == recordings[0].size() && WasSetBack(files);
      }))
    return;
  for (const std::vector<Part*>& files : recordings)
    for (std::size_t k = 0; k < files.size(); ++k) files[k]->epoch = k;
}

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
    const Part &next = (*parts_)[next_part_], &last = (*parts_)[heads_.top().part];
    return next.epoch == last.epoch && heads_.size() < kMaxOpen &&
           (!next.begin || *next.begin <= heads_.top().message.log_time);
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
    std::vector<Part> parts;
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
    FindEpochs(parts);
    std::stable_sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) {
      return std::pair(a.epoch, a.begin) < std::pair(b.epoch, b.begin);
    });
    parts_ = std::make_shared<const std::vector<Part>>(std::move(parts));
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
