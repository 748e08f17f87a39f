#pragma once

#include <algorithm>
#include <cassert>
#include <deque>
#include <vector>

#include "core/drive_log.h"

namespace parkade {

inline ImuSample InterpolateSamples(const ImuSample& from, const ImuSample& to, Timestamp time) {
  const double f = (time - from.time) / (to.time - from.time);
  return {time, from.angular_velocity + f * (to.angular_velocity - from.angular_velocity),
          from.linear_acceleration + f * (to.linear_acceleration - from.linear_acceleration)};
}

inline WheelSample InterpolateSamples(const WheelSample& from, const WheelSample& to,
                                      Timestamp time) {
  const double f = (time - from.time) / (to.time - from.time);
  return {time, from.forward_speed + f * (to.forward_speed - from.forward_speed),
          from.yaw_rate + f * (to.yaw_rate - from.yaw_rate)};
}

/// The recent samples of one sensor in order of time, with linear interpolation
/// between them.
template <typename Sample>
class SampleBuffer {
 public:
  /// Keeps `sample` if it is later than all before; says whether it did.
  bool Add(const Sample& sample) {
    if (!samples_.empty() && sample.time <= samples_.back().time) return false;
    samples_.push_back(sample);
    return true;
  }

  /// Forgets what no interpolation at or after `time` needs.
  void DropBefore(Timestamp time) {
    while (samples_.size() > 2 && samples_[1].time <= time) samples_.pop_front();
  }

  /// The value at `time`; the nearest sample's outside the span. Not empty.
  Sample At(Timestamp time) const {
    assert(!samples_.empty());
    const auto after = LowerBound(time);
    if (after == samples_.end() || after == samples_.begin()) {
      Sample held = after == samples_.end() ? samples_.back() : samples_.front();
      held.time = time;
      return held;
    }
    if (after->time == time) return *after;
    return InterpolateSamples(*std::prev(after), *after, time);
  }

  /// The samples strictly inside (begin, end), with interpolated ones at both
  /// ends. Needs begin < end and a buffer that is not empty.
  std::vector<Sample> Between(Timestamp begin, Timestamp end) const {
    assert(begin < end);
    std::vector<Sample> inside{At(begin)};
    for (auto it = LowerBound(begin); it != samples_.end() && it->time < end; ++it)
      if (it->time > begin) inside.push_back(*it);
    inside.push_back(At(end));
    return inside;
  }

  /// Longest time [s] without a sample that meets [begin, end]; infinite when
  /// the samples do not span it.
  double LongestGap(Timestamp begin, Timestamp end) const {
    if (samples_.empty() || begin < samples_.front().time || samples_.back().time < end)
      return std::numeric_limits<double>::infinity();
    double longest = 0;
    auto it = LowerBound(begin);
    Timestamp last = it == samples_.begin() ? it->time : std::prev(it)->time;
    for (; it != samples_.end(); ++it) {
      longest = std::max(longest, it->time - last);
      last = it->time;
      if (it->time >= end) break;
    }
    return longest;
  }

  bool empty() const { return samples_.empty(); }
  const Sample& front() const { return samples_.front(); }
  const Sample& back() const { return samples_.back(); }

 private:
  typename std::deque<Sample>::const_iterator LowerBound(Timestamp time) const {
    return std::lower_bound(samples_.begin(), samples_.end(), time,
                            [](const Sample& sample, Timestamp t) { return sample.time < t; });
  }

  std::deque<Sample> samples_;
};

using ImuBuffer = SampleBuffer<ImuSample>;
using WheelBuffer = SampleBuffer<WheelSample>;

}  // namespace parkade
