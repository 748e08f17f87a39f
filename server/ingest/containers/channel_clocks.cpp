#include "server/ingest/containers/channel_clocks.h"

#include <algorithm>

namespace parkade {

void ChannelClocks::Add(std::uint32_t channel, Timestamp log_time) {
  constexpr double kStepBack = 2;  // [s]
  Clock& clock = clocks_[channel];
  const bool is_set_back = clock.num_messages > 0 && clock.latest - log_time > kStepBack;
  clock.num_steps_back += is_set_back ? 1 : 0;
  clock.latest =
      clock.num_messages == 0 || is_set_back ? log_time : std::max(clock.latest, log_time);
  ++clock.num_messages;
}

bool ChannelClocks::WereSetBack() const {
  constexpr std::uint64_t kMinMessages = 10, kMaxSteps = 10;
  int num_set_back = 0, num_steady = 0;
  for (const auto& [channel, clock] : clocks_) {
    if (clock.num_messages < kMinMessages) continue;
    const bool is_set_back = clock.num_steps_back > 0 && clock.num_steps_back <= kMaxSteps;
    ++(is_set_back ? num_set_back : num_steady);
  }
  return num_set_back > num_steady;
}

}  // namespace parkade
