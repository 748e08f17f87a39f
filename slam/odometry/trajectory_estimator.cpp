#include "slam/odometry/trajectory_estimator.h"

#include <algorithm>
#include <cmath>

namespace parkade {
namespace {

constexpr double kSnapSlack = 0.05;  // [s] of data beyond a node before it is placed
constexpr double kMaxImuGap = 0.5;   // [s] bridged silently
constexpr double kMaxEarlyFrames =
    30.0;  // [s] of images kept to run backwards over the time before the start

bool IsFinite(const ImuSample& sample) {
  return sample.angular_velocity.allFinite() && sample.linear_acceleration.allFinite();
}

}  // namespace

TrajectoryEstimator::TrajectoryEstimator(const Rig& rig, const OdometryOptions& options)
    : rig_(rig),
      options_(options),
      standstill_(rig.imu, rig.cameras.size(), options.standstill),
      smoother_(rig, options.smoother),
      builder_(rig, options.output_interval),
      last_frame_(rig.cameras.size()),
      tracks_seen_(rig.cameras.size(), 0),
      measurements_(std::make_shared<DriveMeasurements>(rig.imu)) {
  options_.Validate();
  for (const RigCamera& camera : rig.cameras)
    report_.cameras.push_back({camera.name, 0, 0, 0, 0, 1});
}

void TrajectoryEstimator::Add(const ImuSample& sample) {
  if (!IsFinite(sample)) return;
  if (imu_.empty()) log_begin_ = sample.time;
  const Timestamp before = imu_.empty() ? sample.time : imu_.back().time;
  if (!imu_.Add(sample)) return;
  if (IsEarly(sample.time)) early_.imu.push_back(sample);
  if (sample.time - before > kMaxImuGap)
    AddDegraded(before, sample.time, "the IMU delivered nothing; bridged by images and wheels");
  Advance();
}

void TrajectoryEstimator::Add(const WheelSample& sample) {
  if (!options_.use_wheels || !std::isfinite(sample.forward_speed)) return;
  if (!wheels_.Add(sample)) return;
  report_.has_wheels = true;
  if (IsEarly(sample.time)) early_.wheels.push_back(sample);
}

void TrajectoryEstimator::Add(TrackedFrame frame) {
  const auto camera = static_cast<size_t>(frame.camera);
  CameraHealth& health = report_.cameras[camera];
  ++health.frames;
  if (frame.observations.empty() || (health.frames > 1 && frame.time <= last_frame_[camera]))
    return;
  last_frame_[camera] = frame.time;
  standstill_.Add(frame);
  if (IsEarly(frame.time)) {
    early_.frames.push_back(frame);
    if (frame.time - early_.frames.front().time > kMaxEarlyFrames)
      early_.frames.erase(early_.frames.begin());
  }
  frame.time_offset = smoother_.cameras()[camera].time_offset();
  frame.time = frame.time + frame.time_offset;
  if (is_started_ && frame.time <= last_node_) return;
  const auto later =
      std::upper_bound(pending_.begin(), pending_.end(), frame.time,
                       [](Timestamp time, const TrackedFrame& other) { return time < other.time; });
  pending_.insert(later, std::move(frame));
}

std::optional<MotionState> TrajectoryEstimator::Latest() const {
  if (!is_started_) return std::nullopt;
  return smoother_.Latest();
}

std::vector<Rigid3> TrajectoryEstimator::ImuFromCameras() const {
  std::vector<Rigid3> poses;
  for (const CameraParameters& camera : smoother_.cameras())
    poses.push_back(camera.ImuFromCamera());
  return poses;
}

void TrajectoryEstimator::Advance() {
  if (!is_started_) TryStart(/*is_last_chance=*/false);
  if (is_started_) PlaceNodes(imu_.back().time - kSnapSlack);
}

void TrajectoryEstimator::AddDegraded(Timestamp begin, Timestamp end, const std::string& reason) {
  for (auto it = report_.degraded.rbegin(); it != report_.degraded.rend(); ++it) {
    if (it->reason != reason) continue;
    if (begin - it->end > (reason.starts_with(kNoCamera) ? 1e-6 : 0.5)) break;
    it->end = std::max(it->end, end);
    return;
  }
  report_.degraded.push_back({begin, end, reason});
}

}  // namespace parkade
