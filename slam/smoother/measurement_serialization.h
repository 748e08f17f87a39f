#pragma once

#include "core/binary_serialization.h"
#include "slam/smoother/recorded_states.h"

// What DriveMeasurements keeps on disk, for BinaryWriter and BinaryReader. In the order of odometry
// files: a change needs a new version of those.
namespace parkade {

template <typename A>
void Serialize(A& archive, MotionState& state) {
  archive(state.time, state.odom_from_imu, state.velocity_in_odom, state.gyroscope_bias,
          state.accelerometer_bias);
}
template <typename A>
void Serialize(A& archive, ImuSample& sample) {
  archive(sample.time, sample.angular_velocity, sample.linear_acceleration);
}
template <typename A>
void Serialize(A& archive, ImuBias& bias) {
  archive(bias.gyroscope, bias.accelerometer);
}
template <typename A>
void Serialize(A& archive, WheelPreintegration& wheels) {
  archive(wheels.duration, wheels.displacement, wheels.d_gyroscope_bias, wheels.gyroscope_bias,
          wheels.covariance, wheels.body_in_imu);
}
template <typename A>
void Serialize(A& archive, NodeInterpolation& interpolation) {
  archive(interpolation.fraction, interpolation.rotation_since_first,
          interpolation.rotation_over_interval, interpolation.bend);
}
template <typename A>
void Serialize(A& archive, RecordedObservation& observation) {
  archive(observation.track, observation.bearing, observation.sigma, observation.row);
}
template <typename A>
void Serialize(A& archive, RecordedImage& image) {
  archive(image.time, image.camera, image.time_offset, image.first_node, image.second_node,
          image.interpolation, image.angular_velocity, image.observations);
}
template <typename A>
void Serialize(A& archive, RecordedInterval& interval) {
  archive(interval.samples, interval.bias, interval.wheels, interval.is_still);
}

template <typename A>
void Serialize(A& archive, CameraParameters& camera) {
  archive(camera.extrinsics, camera.timing);
}
template <typename A>
void Serialize(A& archive, CameraSigmas& sigmas) {
  archive(sigmas.rotation, sigmas.translation, sigmas.time_offset, sigmas.line_delay);
}
template <typename A>
void Serialize(A& archive, RecordedNode& node) {  // its interval follows
  archive(node.number, node.state, node.covariance);
}
template <typename A>
void Serialize(A& archive, SharedFindings& shared) {
  archive(shared.cameras, shared.camera_priors, shared.camera_noise_scales, shared.wheel_scale,
          shared.has_jumps);
}

}  // namespace parkade
