#include "server/ingest/containers/damage.h"

#include <set>
#include <utility>

namespace parkade {

DamageReport OfWanted(const DamageReport& damage, const std::vector<TopicInfo>& topics,
                      const std::vector<bool>& wanted) {
  std::set<std::string> unwanted;
  for (std::size_t i = 0; i < topics.size(); ++i)
    if (!wanted[i]) unwanted.insert(topics[i].topic);
  DamageReport rest = damage;
  std::erase_if(rest.ranges, [&](const LostRange& range) {
    const bool is_unwanted = unwanted.contains(range.topic);
    if (is_unwanted) rest.num_lost_messages -= range.num_messages;
    return is_unwanted;
  });
  return rest;
}

void ChannelLosses::Add(ChannelLoss loss) {
  constexpr std::size_t kMaxLosses = 100'000;
  if (losses_.size() < kMaxLosses) losses_.push_back(std::move(loss));
}

void ChannelLosses::AddTo(DamageReport& damage, const TopicMap& topics) {
  for (ChannelLoss& loss : losses_) {
    const int topic = loss.channel ? topics.TopicOf(*loss.channel).value_or(-1) : -1;
    const std::string name = topic < 0 ? "" : topics.topics[static_cast<std::size_t>(topic)].topic;
    AddLoss(damage, {std::move(loss.what), name, loss.lost.time, loss.lost.num_messages});
  }
}

}  // namespace parkade
