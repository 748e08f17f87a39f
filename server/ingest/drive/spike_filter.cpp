#include "server/ingest/drive/spike_filter.h"

#include <algorithm>
#include <utility>

namespace parkade {
namespace {

constexpr double kMaxStep = 0.05;  // [s] between neighbors
constexpr double kRateJump = 5;    // [rad/s], far beyond what a car does from sample to sample
constexpr double kAccelerationJump = 80;  // [m/s^2]
constexpr double kNear = 0.2;             // of the jump, that neighbors may differ by

bool Jumps(const Eigen::Vector3d& before, const Eigen::Vector3d& sample,
           const Eigen::Vector3d& after, double limit) {
  const double jump = std::min((sample - before).norm(), (sample - after).norm());
  return jump > limit && (after - before).norm() < kNear * jump;
}

bool IsSpike(const ImuSample& before, const ImuSample& sample, const ImuSample& after) {
  if (sample.time - before.time > kMaxStep || after.time - sample.time > kMaxStep) return false;
  return Jumps(before.angular_velocity, sample.angular_velocity, after.angular_velocity,
               kRateJump) ||
         Jumps(before.linear_acceleration, sample.linear_acceleration, after.linear_acceleration,
               kAccelerationJump);
}

const ImuSample& SampleOf(const Arrival& arrival) { return std::get<ImuSample>(arrival.content); }

}  // namespace

SpikeFilter::Result SpikeFilter::Push(Arrival arrival) {
  Result result;
  if (held_ && last_ && IsSpike(*last_, SampleOf(*held_), SampleOf(arrival)))
    result.is_spike = true;
  else
    result.good = Finish();
  held_ = std::move(arrival);
  return result;
}

std::optional<Arrival> SpikeFilter::Finish() {
  if (held_) last_ = SampleOf(*held_);
  return std::exchange(held_, std::nullopt);
}

}  // namespace parkade
