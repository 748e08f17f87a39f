#pragma once

#include "core/binary_serialization.h"
#include "slam/odometry/odometry_result.h"

// What an odometry file holds beside the measurements, for BinaryWriter and BinaryReader. Fields
// are in the order of the file: a change needs a new version of it.
namespace parkade {

template <typename A>
void Serialize(A& archive, OdometryKeyframe& keyframe) {
  archive(keyframe.time, keyframe.camera, keyframe.odom_from_body);
}
template <typename A>
void Serialize(A& archive, Landmark& landmark) {
  archive(landmark.time, landmark.camera, landmark.point_in_odom, landmark.sigma,
          landmark.num_observations);
}
template <typename A>
void Serialize(A& archive, DegradedInterval& interval) {
  archive(interval.begin, interval.end, interval.reason);
}
template <typename A>
void Serialize(A& archive, CameraHealth& health) {
  archive(health.name, health.frames, health.frames_used, health.frames_rejected,
          health.tracks_per_frame, health.noise_scale);
}
template <typename A>
void Serialize(A& archive, CalibratedQuantity& quantity) {
  archive(quantity.name, quantity.change, quantity.sigma, quantity.status);
}
template <typename A>
void Serialize(A& archive, CameraCalibration& calibration) {
  archive(calibration.name, calibration.quantities);
}
template <typename A>
void Serialize(A& archive, OdometryReport& report) {
  archive(report.start_kind, report.start_time, report.start_data, report.cameras,
          report.calibration, report.degraded, report.nodes, report.solves,
          report.mean_solve_seconds, report.max_solve_seconds, report.mean_bearings, report.seconds,
          report.length, report.still_seconds, report.has_wheels, report.wheel_scale,
          report.wheels_left_out, report.gyroscope_bias, report.accelerometer_bias);
}

}  // namespace parkade
