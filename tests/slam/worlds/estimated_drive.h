#pragma once

#include "slam/evaluation/evaluate_trajectory.h"
#include "slam/odometry/trajectory_estimator.h"
#include "tests/support/sampled_drive.h"

namespace parkade {

/// The estimator's answer to a synthetic drive, and its error.
struct EstimatedDrive {
  OdometryResult odometry;
  TrajectoryEvaluation error;
};

/// Feeds a drive in order of time.
inline OdometryResult EstimateDrive(const SampledDrive& drive,
                                    const OdometryOptions& options = {}) {
  TrajectoryEstimator estimator(drive.rig, options);
  size_t wheel = 0, frame = 0;
  for (const ImuSample& sample : drive.imu) {
    while (wheel < drive.wheels.size() && drive.wheels[wheel].time <= sample.time)
      estimator.Add(drive.wheels[wheel++]);
    while (frame < drive.frames.size() && drive.frames[frame].time <= sample.time)
      estimator.Add(drive.frames[frame++]);
    estimator.Add(sample);
  }
  return estimator.Finish();
}

inline EstimatedDrive EstimateAndCompare(const SampledDrive& drive,
                                         const OdometryOptions& options = {}) {
  EstimatedDrive estimated{EstimateDrive(drive, options), {}};
  estimated.error =
      EvaluateTrajectory(drive.truth, ToTimedPoses(estimated.odometry.odom_from_body));
  return estimated;
}

}  // namespace parkade
