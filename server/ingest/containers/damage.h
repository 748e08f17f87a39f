#pragma once

#include "server/ingest/containers/raw_message.h"

namespace parkade {

/// Counts a loss; beyond 1000 ranges only the number of messages grows.
inline void AddLoss(DamageReport& damage, LostRange range) {
  constexpr std::size_t kMaxRanges = 1000;
  damage.num_lost_messages += range.num_messages;
  if (damage.ranges.size() < kMaxRanges) damage.ranges.push_back(std::move(range));
}

/// The part of `damage` that concerns the wanted topics or unknown ones.
DamageReport OfWanted(const DamageReport& damage, const std::vector<TopicInfo>& topics,
                      const std::vector<bool>& wanted);

}  // namespace parkade
