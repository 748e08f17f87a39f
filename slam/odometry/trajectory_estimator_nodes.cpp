// Where TrajectoryEstimator places nodes, and what it feeds the smoother with.
#include <algorithm>

#include "slam/odometry/trajectory_estimator.h"

namespace parkade {
namespace {

constexpr double kMinInterval = 0.01;  // [s] between nodes
constexpr double kSnap = 0.03;         // [s] a node moves this far to be at an image
constexpr double kStillLook = 0.3;     // [s] over which standstill is judged
constexpr double kWheelDoubt = 0.3;    // [s] a car may have moved before its wheels show it
constexpr double kImageDoubt = 0.6;    // [s] a car may have moved before its images show it
constexpr double kRateSpan =
    0.04;  // [s] before and after an image over which its rotation rate is averaged
constexpr double kShortInterval = 0.05;  // [s] an interval this short needs no image
constexpr int kFewBearings = 8;          // fewer say next to nothing

int CountCommon(const TrackedFrame& frame) { return static_cast<int>(frame.observations.size()); }

/// Biased rotation rate [rad/s] around `time`: one sample alone is mostly noise, which as a
/// derivative by time would pass for knowledge of time offsets.
Eigen::Vector3d MeanRate(const ImuBuffer& imu, Timestamp time) {
  const std::vector<ImuSample> samples = imu.Between(time - kRateSpan, time + kRateSpan);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const ImuSample& sample : samples) sum += sample.angular_velocity;
  return sum / static_cast<double>(samples.size());
}

bool SeesTracksOfOthers(const TrackedFrame& frame) {
  return !frame.observations.empty() && (frame.observations.back().track >> 40) != frame.camera;
}

}  // namespace

Timestamp TrajectoryEstimator::SnapToImage(Timestamp time) const {
  Timestamp best = time;
  double nearest = kSnap;
  for (const TrackedFrame& frame : pending_) {
    if (frame.time > time + kSnap) break;
    const double distance = std::abs(frame.time - time);
    if (frame.time > last_cut_ && distance < nearest) {
      nearest = distance;
      best = frame.time;
    }
  }
  const Timestamp newest =
      imu_.back().time;  // no sliver of an interval may remain at the end of the log
  return std::abs(newest - best) < kMinInterval ? newest : best;
}

double TrajectoryEstimator::NextInterval() const {
  const NodeOptions& nodes = options_.nodes;
  const MotionState state = smoother_.Latest();
  const double rate = (imu_.At(last_cut_).angular_velocity - state.gyroscope_bias).norm();
  const double due = std::min(nodes.distance / std::max(state.velocity_in_odom.norm(), 1e-3),
                              nodes.rotation / std::max(rate, 1e-3));
  return std::clamp(due, nodes.interval, nodes.slow_interval);
}

void TrajectoryEstimator::PlaceNodes(Timestamp until) {
  for (Timestamp cut; (cut = SnapToImage(last_cut_ + options_.nodes.interval)) <= until;
       last_cut_ = cut) {
    const Timestamp look = std::max(imu_.front().time, cut - kStillLook);
    const bool is_still =
        cut > surely_moving_until_ && standstill_.IsStill(imu_, wheels_, look, cut, is_run_still_);
    const Timestamp surely_still = cut - (report_.has_wheels ? kWheelDoubt : kImageDoubt);
    if (is_run_still_ && !is_still) {
      // The car moved before it was seen to: go back to where it surely stood.
      if (surely_still > last_node_) MakeNode(surely_still, true);
      surely_moving_until_ = cut;
      is_run_still_ = false;
      cut = last_node_;
      continue;
    }
    if (is_still && !is_run_still_ && last_cut_ > last_node_) MakeNode(last_cut_, false);
    is_run_still_ = is_still;
    const Timestamp node = is_still ? surely_still : cut;
    if (node - last_node_ > (is_still ? options_.nodes.still_interval : NextInterval()) - kSnap)
      MakeNode(node, is_still);
  }
}

std::vector<NewImage> TrajectoryEstimator::TakeImages(const ImuPreintegration& imu) {
  // One image per camera and interval: the last one in which other cameras' tracks were found, else
  // the last.
  std::vector<TrackedFrame*> chosen(rig_.cameras.size(), nullptr);
  size_t num_taken = 0;
  for (; num_taken < pending_.size() && pending_[num_taken].time <= imu.end(); ++num_taken) {
    TrackedFrame& frame = pending_[num_taken];
    TrackedFrame*& choice = chosen[static_cast<size_t>(frame.camera)];
    if (!choice || SeesTracksOfOthers(frame) || !SeesTracksOfOthers(*choice)) choice = &frame;
  }
  std::vector<NewImage> images;
  const Eigen::Quaterniond odom_from_first = smoother_.Latest().odom_from_imu.rotation;
  for (TrackedFrame* frame : chosen) {
    if (!frame) continue;
    NodeInterpolation interpolation;
    interpolation.fraction = 1;
    const Eigen::Vector3d angular_velocity = MeanRate(imu_, frame->time);
    if (frame->time < imu.end()) {
      const std::vector<ImuSample> part = imu_.Between(imu.begin(), frame->time);
      interpolation =
          MakeNodeInterpolation(Integrate(part, imu.bias()), imu.increment(), odom_from_first);
    }
    const auto camera = static_cast<size_t>(frame->camera);
    ++report_.cameras[camera].frames_used;
    tracks_seen_[camera] += CountCommon(*frame);
    used_images_.push_back({frame->time + -frame->time_offset, frame->camera});
    images.push_back({std::move(*frame), interpolation, angular_velocity});
  }
  std::sort(images.begin(), images.end(), [](const NewImage& a, const NewImage& b) {
    return std::pair(a.frame.time, a.frame.camera) < std::pair(b.frame.time, b.frame.camera);
  });
  pending_.erase(pending_.begin(), pending_.begin() + static_cast<long>(num_taken));
  return images;
}

void TrajectoryEstimator::MakeNode(Timestamp time, bool is_still) {
  const MotionState last = smoother_.Latest();
  NodeInterval interval{ImuPreintegration(imu_.Between(last_node_, time),
                                          {last.gyroscope_bias, last.accelerometer_bias}, rig_.imu),
                        {},
                        is_still};
  if (!is_still && wheels_.LongestGap(last_node_, time) < kMaxWheelGap)
    interval.wheels =
        PreintegrateWheels(interval.imu.samples(), wheels_.Between(last_node_, time),
                           last.gyroscope_bias, rig_.body_from_imu.Inverse(), options_.wheels);
  std::vector<NewImage> images = TakeImages(interval.imu);
  if (is_still) {
    report_.still_seconds += interval.imu.duration();
    images.clear();  // nothing to learn from them but other cars' motion
  }
  int bearings_seen = 0;
  for (const NewImage& image : images) bearings_seen += CountCommon(image.frame);
  if (!is_still) NoteDegradation(last_node_, time, bearings_seen, interval.wheels.has_value());
  smoother_.AddNode(std::move(interval), std::move(images));
  last_node_ = time;
  SolveAndCollect();
  imu_.DropBefore(time - 1.0);
  wheels_.DropBefore(time - 1.0);
}

void TrajectoryEstimator::SolveAndCollect() {
  const SolveSummary solve = smoother_.Solve();
  ++report_.solves;
  sum_solve_seconds_ += solve.seconds;
  report_.max_solve_seconds = std::max(report_.max_solve_seconds, solve.seconds);
  sum_bearings_ += solve.bearings;
  Collect(smoother_.DropOldest());
}

void TrajectoryEstimator::Collect(std::vector<FinishedNode> finished) {
  report_.nodes += static_cast<int>(finished.size());
  for (FinishedNode& node : finished) {
    measurements_->AddNode({node.number, node.state, node.covariance}, node.interval);
    if (options_.smooth_backwards) conditionals_.Add(std::move(node.conditionals));
  }
  for (RecordedImage& image : smoother_.TakeImages()) measurements_->AddImage(std::move(image));
  std::vector<FinishedLandmark> landmarks = smoother_.TakeLandmarks();
  std::move(landmarks.begin(), landmarks.end(), std::back_inserter(landmarks_));
}

void TrajectoryEstimator::NoteDegradation(Timestamp begin, Timestamp end, int bearings_seen,
                                          bool has_wheels) {
  if (end - begin < kShortInterval) return;  // shorter than a camera's, at the end of the log
  if (bearings_seen < kFewBearings)
    AddDegraded(begin, end,
                std::string(kNoCamera) +
                    (has_wheels ? "; IMU and wheels carry on" : "; the IMU alone carries on"));
  else if (report_.has_wheels && !has_wheels)
    AddDegraded(begin, end, "the wheels delivered nothing");
}

}  // namespace parkade
