#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/field_map.h"
#include "server/ingest/schemas/message_path.h"

namespace parkade {

using SignalValues = std::map<std::string, double>;

/// The signals of one sensor in one pass over a log. Where they stand in several topics, a message
/// of the topic of the first signal (by the alphabet, but for `stamp`) sets the time, and the
/// others have the value that came last.
class SignalReader {
 public:
  /// \param topics  of the log, that signals name
  /// Throws Error{kInvalidInput} where a path is none.
  SignalReader(const FieldSignals& signals, const std::vector<TopicInfo>& topics);

  /// Indices of the topics that hold signals.
  const std::set<int>& topics() const { return topics_; }

  /// Takes a message of one of the topics. The values of all signals, where this message sets the
  /// time and none is missing.
  std::optional<SignalValues> Take(int topic, const MessageTree& message);

  /// The names of signals that no message has had so far.
  std::vector<std::string> Missing() const;

 private:
  struct Signal {
    std::string name;
    int topic = 0;
    MessagePath path;
    double scale = 1, offset = 0;
    std::optional<double> value = {};
  };

  std::vector<Signal> signals_;
  std::set<int> topics_;
  int main_topic_ = -1;
};

}  // namespace parkade
