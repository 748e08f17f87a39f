#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "server/ingest/containers/channel_table.h"
#include "server/ingest/containers/raw_message.h"

namespace parkade {

/// Counts a loss; beyond 1000 ranges only the number of messages grows.
inline void AddLoss(DamageReport& damage, LostRange range) {
  constexpr std::size_t kMaxRanges = 1000;
  damage.num_lost_messages += range.num_messages;
  if (damage.ranges.size() < kMaxRanges) damage.ranges.push_back(std::move(range));
}

/// Says that the log's archive could not be read to its end; `reason` is a phrase, empty where it
/// could.
inline void AddArchiveDamage(DamageReport& damage, const std::string& reason) {
  if (reason.empty()) return;
  AddLoss(damage, {"the archive cannot be read to its end: " + reason, "", {}, 0});
  damage.is_truncated = true;
}

/// The part of `damage` that concerns the wanted topics or unknown ones.
DamageReport OfWanted(const DamageReport& damage, const std::vector<TopicInfo>& topics,
                      const std::vector<bool>& wanted);

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
