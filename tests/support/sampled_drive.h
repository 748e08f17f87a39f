#pragma once

#include <cstdint>
#include <vector>

#include "core/drive_log.h"
#include "core/rig.h"
#include "core/trajectory.h"
#include "slam/tracking/feature_track.h"
#include "tests/support/synthetic_motion.h"

namespace parkade {

/// A drive without images: samples and tracks from an exact motion through a
/// world of points, with noise of known size. Same options, same numbers.
struct SampledDriveOptions {
  std::uint32_t seed = 1;
  double duration = 50;     ///< [s]
  double start = 0;         ///< [s] into the motion: > 6 starts rolling
  double imu_rate = 200;    ///< [Hz]
  double wheel_rate = 50;   ///< [Hz]
  double camera_rate = 20;  ///< [Hz]
  int num_cameras = 4;      ///< 1..4: front, left, right, rear
  bool has_wheels = true;
  double wheel_scale = 1.005;        ///< true speed / reported speed
  double wheel_noise = 0.02;         ///< [m/s]
  double gyroscope_bias = 0.005;     ///< [rad/s] standard deviation per axis
  double accelerometer_bias = 0.05;  ///< [m/s^2] standard deviation per axis
  double noise = 1;                  ///< of the IMU, times that of its calibration
  double bearing_sigma = 1.2e-3;     ///< [rad]
  int tracks = 60;                   ///< per image
  double outliers = 0.03;            ///< share of tracks that wander
  double points_per_meter = 8;       ///< of path (car), or 50 times per room (flight)
  // What is wrong with the rig that the estimator gets, per camera, in random directions.
  double rig_rotation_deg = 0;
  double rig_translation = 0;   ///< [m]
  double time_offset = 0;       ///< [s] by which stamps are early (odd cameras: late)
  double line_delay = 0;        ///< [s/row] of all cameras
  double line_delay_error = 0;  ///< share of it that the rig says too much
  int jump_camera = -1;         ///< whose mount turns at once
  double jump_time = 0;         ///< [s] after the start
  double jump_deg = 0;
};

struct SampledDrive {
  Rig rig;       ///< as the estimator gets it
  Rig true_rig;  ///< at the end of the drive
  std::vector<ImuSample> imu;
  std::vector<WheelSample> wheels;
  std::vector<TrackedFrame> frames;  ///< all cameras, in order of time
  std::vector<TimedPose> truth;      ///< world_from_body at 100 Hz
  double length = 0;                 ///< [m]
};

/// Four unsynchronized 185-degree cameras on a car, IMU off the rear axle.
SampledDrive MakeCarDrive(const SampledDriveOptions& options);

/// A car on a circle (BendMotion), moving from the first instant, with one camera or with two side
/// by side, 0.54 m apart, that look ahead, 60 degrees to each side, and see points up to 60 m away.
/// Two see the same points under the same track numbers, though not at the same time.
SampledDrive MakeBendDrive(const SampledDriveOptions& options, double speed, double yaw_rate);

/// A standing car with the same sensors.
SampledDrive MakeRestingDrive(const SampledDriveOptions& options);

/// A drone with one camera (num_cameras and has_wheels are ignored); body = imu.
SampledDrive MakeFlight(const SampledDriveOptions& options);

/// All images of `camera` (-1: of all cameras) within [begin, end] s after the start removed.
void RemoveImages(SampledDrive& drive, int camera, double begin, double end);
/// All IMU samples within (begin, end) removed.
void RemoveImu(SampledDrive& drive, double begin, double end);

}  // namespace parkade
