#include "slam/run_backwards.h"

#include <algorithm>

#include "slam/trajectory_estimator.h"

namespace parkade {
namespace {

// What remains unknown of a state that the forward run has smoothed.
constexpr StartUncertainty kUncertainty{0.01, 0.05, 2e-3, 0.03};

Timestamp Mirrored(Timestamp time, Timestamp about) { return {2 * about.ns - time.ns}; }

template <typename Record>
std::vector<Record> LastToFirst(const std::vector<Record>& records, Timestamp about) {
  std::vector<Record> mirrored;
  for (auto record = records.rbegin(); record != records.rend(); ++record) {
    if (record->time > about) continue;
    mirrored.push_back(*record);
    mirrored.back().time = Mirrored(record->time, about);
  }
  return mirrored;
}

}  // namespace

std::vector<TrajectoryState> RunBackwards(const Rig& rig, const OdometryOptions& options, const EarlyRecords& records,
                                          const MotionState& at_end) {
  std::vector<ImuSample> imu = LastToFirst(records.imu, at_end.time);
  if (imu.size() < 2) return {};
  for (ImuSample& sample : imu) sample.angular_velocity *= -1;
  std::vector<WheelSample> wheels = LastToFirst(records.wheels, at_end.time);
  for (WheelSample& sample : wheels) {
    sample.forward_speed *= -1;
    sample.yaw_rate *= -1;
  }
  std::vector<TrackedFrame> frames = LastToFirst(records.frames, at_end.time);

  MotionState start = at_end;
  start.velocity_in_odom *= -1;
  start.gyroscope_bias *= -1;
  Rig mirrored = rig;
  for (RigCamera& camera : mirrored.cameras) camera.line_delay *= -1;
  TrajectoryEstimator estimator(mirrored, options);
  estimator.BeginFrom(start, kUncertainty);
  size_t wheel = 0, frame = 0;
  for (const ImuSample& sample : imu) {
    for (; wheel < wheels.size() && wheels[wheel].time <= sample.time; ++wheel) estimator.Add(wheels[wheel]);
    for (; frame < frames.size() && frames[frame].time <= sample.time; ++frame) estimator.Add(std::move(frames[frame]));
    estimator.Add(sample);
  }
  std::vector<TrajectoryState> states = estimator.Finish().odom_from_body.states();
  std::reverse(states.begin(), states.end());
  for (TrajectoryState& state : states) {
    state.time = Mirrored(state.time, at_end.time);
    state.velocity_in_odom *= -1;
    state.gyroscope_bias *= -1;
  }
  return states;
}

}  // namespace parkade
