#include "server/ingest/drive/timestamp_filter.h"

#include <algorithm>

namespace parkade {
namespace {

constexpr double kMaxStep = 1;        // [s] between records that follow each other without question
constexpr double kMaxAheadOfImu = 2;  // [s]
constexpr double kMaxLeadStep = 0.5;  // [s] by which a stream may come to lead the IMU by more
constexpr double kMaxBehindImu = 10;  // [s]
constexpr std::size_t kMaxHeld = 5;

}  // namespace

bool TimestampFilter::IsNear(Timestamp time, const std::optional<Timestamp>& imu_front) const {
  const double max_ahead = last_ ? std::min(kMaxAheadOfImu, lead_ + kMaxLeadStep) : kMaxAheadOfImu;
  return imu_front && time - *imu_front <= max_ahead && *imu_front - time <= kMaxBehindImu;
}

std::vector<Arrival> TimestampFilter::Push(Arrival arrival,
                                           const std::optional<Timestamp>& imu_front,
                                           StreamHealth& health) {
  std::vector<Arrival> released;
  ReleaseHeld(imu_front, health, released);
  if (last_ && arrival.time <= *last_) {
    ++health.Dropped(arrival.time == *last_ ? DropReason::kRepeated : DropReason::kBackwardStamp);
    return released;
  }
  if (!held_.empty() && arrival.time == held_.back().time) {
    ++health.Dropped(DropReason::kRepeated);
    return released;
  }
  const bool follows = last_ && arrival.time - *last_ <= kMaxStep;
  if (follows || (!is_imu_ && IsNear(arrival.time, imu_front))) {
    DropHeld(health);  // they lie ahead: the stream did not follow them
    if (imu_front) lead_ = std::max(0.0, arrival.time - *imu_front);
    Accept(std::move(arrival), health, released);
    return released;
  }
  const bool follows_held = !held_.empty() && arrival.time > held_.back().time &&
                            arrival.time - held_.back().time <= kMaxStep;
  if (!follows_held && num_challenges_ < held_.size() && held_.size() > 1) {
    ++num_challenges_;
    ++health.Dropped(DropReason::kOffClock);
    return released;
  }
  if (!follows_held) DropHeld(health);
  if (imu_front && (held_.empty() || held_by_ == 0)) held_by_ = arrival.time - *imu_front;
  held_.push_back(std::move(arrival));
  if (held_.size() < kMaxHeld) return released;
  if (is_imu_) {
    for (Arrival& held : held_) Accept(std::move(held), health, released);
    held_.clear();
    num_challenges_ = 0;
  } else {
    DropOneHeld(health);
  }
  return released;
}

std::vector<Arrival> TimestampFilter::Finish(const std::optional<Timestamp>& imu_front,
                                             StreamHealth& health) {
  std::vector<Arrival> released;
  ReleaseHeld(imu_front, health, released);
  DropHeld(health);
  return released;
}

void TimestampFilter::ReleaseHeld(const std::optional<Timestamp>& imu_front, StreamHealth& health,
                                  std::vector<Arrival>& released) {
  while (!is_imu_ && !held_.empty() && IsNear(held_.front().time, imu_front)) {
    Accept(std::move(held_.front()), health, released);
    held_.pop_front();
  }
}

void TimestampFilter::Accept(Arrival arrival, StreamHealth& health,
                             std::vector<Arrival>& released) {
  last_ = arrival.time;
  health.Include(arrival.time);
  released.push_back(std::move(arrival));
}

void TimestampFilter::DropOneHeld(StreamHealth& health) {
  if (health.off_clock_by == 0) health.off_clock_by = held_by_;
  ++health.Dropped(DropReason::kOffClock);
  held_.pop_front();
}

void TimestampFilter::DropHeld(StreamHealth& health) {
  while (!held_.empty()) DropOneHeld(health);
  num_challenges_ = 0;
}

}  // namespace parkade
