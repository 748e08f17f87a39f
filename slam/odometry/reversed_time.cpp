#include "slam/odometry/reversed_time.h"

#include <algorithm>

namespace parkade {
namespace {

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

ReversedDrive ReverseTime(const Rig& rig, const EarlyRecords& records, const MotionState& at_end) {
  ReversedDrive reversed{
      rig,
      at_end,
      {LastToFirst(records.imu, at_end.time), LastToFirst(records.wheels, at_end.time),
       LastToFirst(records.frames, at_end.time)}};
  for (ImuSample& sample : reversed.records.imu) sample.angular_velocity *= -1;
  for (WheelSample& sample : reversed.records.wheels) {
    sample.forward_speed *= -1;
    sample.yaw_rate *= -1;
  }
  reversed.start.velocity_in_odom *= -1;
  reversed.start.gyroscope_bias *= -1;
  for (RigCamera& camera : reversed.rig.cameras) camera.line_delay *= -1;
  return reversed;
}

std::vector<TrajectoryState> ReverseTime(std::vector<TrajectoryState> states, Timestamp about) {
  std::reverse(states.begin(), states.end());
  for (TrajectoryState& state : states) {
    state.time = Mirrored(state.time, about);
    state.velocity_in_world *= -1;
    state.gyroscope_bias *= -1;
  }
  return states;
}

}  // namespace parkade
