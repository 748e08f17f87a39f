#include "server/ingest/checks/speed_history.h"

#include <cmath>

namespace parkade {
namespace {

constexpr double kNear = 0.1;     // [s]
constexpr double kMaxStep = 0.5;  // [s] over which a speed is taken to last

}  // namespace

void SpeedHistory::Include(const WheelSample& sample) {
  if (!samples_.empty() && sample.time - samples_.back().time < kMaxStep)
    length_ += std::abs(sample.forward_speed) * (sample.time - samples_.back().time);
  samples_.push_back(sample);
}

std::optional<WheelSample> SpeedHistory::Near(Timestamp time, std::size_t& hint) const {
  while (hint + 1 < samples_.size() && samples_[hint + 1].time <= time) ++hint;
  for (std::size_t i = hint; i < std::min(hint + 2, samples_.size()); ++i)
    if (std::abs(samples_[i].time - time) < kNear) return samples_[i];
  return std::nullopt;
}

}  // namespace parkade
