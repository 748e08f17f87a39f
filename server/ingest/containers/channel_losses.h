#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "server/ingest/containers/channel_table.h"
#include "server/ingest/containers/raw_message.h"

namespace parkade {

/// How many messages there are, and from when.
struct MessageCount {
  std::uint64_t num_messages = 0;
  TimeSpan time;
};

/// A loss whose topic is known when all channels are.
struct ChannelLoss {
  std::string what;
  std::optional<std::uint32_t> channel;
  MessageCount lost;
};

/// The losses of a log until all its channels are known. Keeps at most 100,000.
class ChannelLosses {
 public:
  void Add(ChannelLoss loss);
  /// Adds all losses to `damage`, under the names of their topics.
  void AddTo(DamageReport& damage, const TopicMap& topics);

 private:
  std::vector<ChannelLoss> losses_;
};

}  // namespace parkade
