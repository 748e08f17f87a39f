#include "server/ingest/schemas/signal_reader.h"

#include <algorithm>

#include "core/error.h"

namespace parkade {
namespace {

int FindTopic(const std::string& wanted, const std::vector<TopicInfo>& topics) {
  const auto plain = [](std::string_view name) {
    return name.starts_with('/') ? name.substr(1) : name;
  };
  std::string known;
  for (std::size_t i = 0; i < topics.size(); ++i) {
    if (plain(topics[i].topic) == plain(wanted)) return static_cast<int>(i);
    known.append(known.empty() ? "" : ", ").append(topics[i].topic);
  }
  throw Error(ErrorCode::kInvalidInput, "the field map of vehicle.yaml names the topic " + wanted +
                                            ", which is not in the log: it has " + known);
}

}  // namespace

SignalReader::SignalReader(const FieldSignals& signals, const std::vector<TopicInfo>& topics) {
  for (const auto& [name, signal] : signals) {
    const int topic = FindTopic(signal.topic, topics);
    signals_.push_back({name, topic, MessagePath(signal.path), signal.scale, signal.offset});
    topics_.insert(topic);
    if (main_topic_ < 0 && name != "stamp") main_topic_ = topic;
  }
}

std::optional<SignalValues> SignalReader::Take(int topic, const MessageTree& message) {
  SignalValues values;
  bool are_all_here = true;
  for (Signal& signal : signals_) {
    if (signal.topic == topic) {
      const std::optional<double> number = signal.path.Number(message);
      if (number) signal.value = signal.scale * *number + signal.offset;
      // Parts of a sensor's messages may be another's: joints of several drivers on one topic.
      are_all_here = are_all_here && (number || topic != main_topic_);
    }
    are_all_here = are_all_here && signal.value;
    if (signal.value) values[signal.name] = *signal.value;
  }
  if (topic != main_topic_ || !are_all_here) return std::nullopt;
  return values;
}

std::vector<std::string> SignalReader::Missing() const {
  std::vector<std::string> names;
  for (const Signal& signal : signals_)
    if (!signal.value) names.push_back(signal.name);
  return names;
}

}  // namespace parkade
