#include "server/ingest/containers/channel_losses.h"

#include <utility>

#include "server/ingest/containers/damage.h"

namespace parkade {

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
