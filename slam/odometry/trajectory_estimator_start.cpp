// How TrajectoryEstimator finds its first state, and fills the time before it.
#include <algorithm>
#include <cmath>

#include "slam/odometry/gate_calibration.h"
#include "slam/odometry/reversed_time.h"
#include "slam/odometry/trajectory_estimator.h"

namespace parkade {
namespace {

constexpr double kStillStart = 0.5;       // [s] of standstill that is enough to start
constexpr double kMaxStillStart = 1.0;    // [s] of it that is used
constexpr double kWheelStart = 1.0;       // [s] of rolling that is enough to start
constexpr double kFirstImageStart = 1.0;  // [s] of moving images for the first attempt
constexpr double kAttemptStep = 0.25;     // [s] between attempts
constexpr double kMinBackwards = 0.3;     // [s] before the first node that are worth it

// Sigmas of a state that the forward run has smoothed.
constexpr StartUncertainty kSmoothedUncertainty{0.01, 0.05, 2e-3, 0.03};

}  // namespace

bool TrajectoryEstimator::IsEarly(Timestamp time) const {
  return !is_started_ || time <= first_node_ + kOverlap;
}

void TrajectoryEstimator::BeginFrom(const MotionState& state, const StartUncertainty& uncertainty) {
  log_begin_ = state.time;
  Begin({StartKind::kMovingInImages, state, uncertainty});
}

void TrajectoryEstimator::TryStart(bool is_last_chance) {
  const Timestamp now = imu_.back().time;
  if (!next_attempt_) {
    start_search_ = imu_.front().time;
    next_attempt_ = start_search_ + kStillStart;
  }
  if (!is_last_chance && now < *next_attempt_) return;
  next_attempt_ = now + kAttemptStep;

  Timestamp begin = std::max(start_search_, imu_.front().time);
  const bool has_wheels = !wheels_.empty() && wheels_.front().time < begin + kWheelStart;
  if (has_wheels) {
    begin = std::max(begin, wheels_.front().time);
  }
  while (!pending_.empty() && pending_.front().time < begin) pending_.pop_front();
  if (!has_wheels) {
    if (pending_.empty()) {  // nothing to see yet
      if (!wheels_.empty()) start_search_ = std::max(begin, wheels_.front().time);
      return;
    }
    begin = pending_.front().time;
  }
  if (now <= begin) return;
  if (const std::optional<StartEstimate> start = AttemptStart(begin, now, is_last_chance)) {
    report_.start_kind = ToText(start->kind);
    report_.start_time = begin - log_begin_;
    report_.start_data = now - begin;
    Begin(*start);
  } else if (now - begin > options_.max_start_time) {
    start_search_ = begin + kAttemptStep;
  }
}

std::optional<StartEstimate> TrajectoryEstimator::AttemptStart(Timestamp begin, Timestamp now,
                                                               bool is_last_chance) const {
  const double seconds = now - begin;
  const Timestamp still_end = begin + std::min(seconds, kMaxStillStart);
  if ((seconds >= kStillStart || is_last_chance) &&
      standstill_.IsStill(imu_, wheels_, begin, still_end))
    return StartFromStandstill(imu_, rig_.imu, begin, still_end);
  const std::vector<TrackedFrame> frames(pending_.begin(), pending_.end());
  const auto bias = [&] {
    return EstimateGyroscopeBias(frames, imu_, rig_)
        .value_or(GyroscopeBiasEstimate{Eigen::Vector3d::Zero(), 0.01});
  };
  if (wheels_.LongestGap(begin, begin + std::min(seconds, kWheelStart)) < kMaxWheelGap) {
    if (seconds < kWheelStart && !is_last_chance) return std::nullopt;
    return StartFromWheels(imu_, wheels_, rig_, bias(), begin,
                           begin + std::min(seconds, kWheelStart));
  }
  // Wheels that arrive a moment after the IMU know the speed better than images.
  if (!wheels_.empty() && seconds < kWheelStart + kAttemptStep && !is_last_chance)
    return std::nullopt;
  if (frames.empty() || (seconds < kFirstImageStart && !is_last_chance)) return std::nullopt;
  return StartFromImages(imu_, frames, rig_, bias(), begin, now);
}

void TrajectoryEstimator::Begin(const StartEstimate& start) {
  const Timestamp time = start.state.time;
  std::vector<NewImage> images;
  while (!pending_.empty() && pending_.front().time <= time) {
    if (pending_.front().time == time) {
      used_images_.push_back({time, pending_.front().camera});
      images.push_back({std::move(pending_.front()),
                        {},
                        imu_.empty() ? Eigen::Vector3d::Zero() : imu_.At(time).angular_velocity});
    }
    pending_.pop_front();
  }
  smoother_.Start(start.state, start.uncertainty, std::move(images));
  is_started_ = true;
  is_start_still_ = start.kind == StartKind::kStandstill;
  is_run_still_ = is_start_still_;
  first_node_ = last_node_ = last_cut_ = time;
}

std::vector<TrajectoryState> TrajectoryEstimator::RunBackwards(const Rig& refined) const {
  ReversedDrive drive = ReverseTime(refined, early_, *after_start_);
  auto& [imu, wheels, frames] = drive.records;
  if (imu.size() < 2) return {};
  TrajectoryEstimator estimator(drive.rig, options_);
  estimator.BeginFrom(drive.start, kSmoothedUncertainty);
  size_t wheel = 0, frame = 0;
  for (const ImuSample& sample : imu) {
    for (; wheel < wheels.size() && wheels[wheel].time <= sample.time; ++wheel)
      estimator.Add(wheels[wheel]);
    for (; frame < frames.size() && frames[frame].time <= sample.time; ++frame)
      estimator.Add(std::move(frames[frame]));
    estimator.Add(sample);
  }
  return ReverseTime(estimator.Finish().odom_from_body.states(), after_start_->time);
}

void TrajectoryEstimator::FillBeforeStart(const Rig& refined,
                                          std::vector<TrajectoryState>& states) {
  if (!(log_begin_ < first_node_) || early_.imu.empty()) return;
  const bool has_images =
      !early_.frames.empty() && early_.frames.front().time < first_node_ - kMinBackwards;
  std::vector<TrajectoryState> before;
  if (has_images && !is_start_still_ && after_start_) {
    for (TrackedFrame& frame : early_.frames)
      frame.time = frame.time + TimeShiftBetween(rig_, refined, frame.camera);
    before = RunBackwards(refined);
    // Both runs know the first node: what they disagree on there is no motion of the car.
    const Trajectory backwards(std::move(before));
    const std::optional<Rigid3> at_first = backwards.At(first_node_);
    before.clear();
    if (at_first)
      before = backwards.Transformed(states.front().world_from_body * at_first->Inverse()).states();
    std::erase_if(before, [&](const TrajectoryState& state) { return state.time >= first_node_; });
  }
  if (before.empty()) before = builder_.StatesBefore(early_, is_start_still_);
  if (first_node_ - log_begin_ > 0.5 && !is_start_still_)
    AddDegraded(log_begin_, first_node_, "before the first estimate; filled by running backwards");
  states.insert(states.begin(), before.begin(), before.end());
}

}  // namespace parkade
