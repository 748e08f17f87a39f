#pragma once

#include <string>
#include <vector>

#include "slam/odometry/odometry_result.h"

namespace parkade {

/// Where a camera sits, by the ways that it goes in turns: without the pair of images that says
/// most.
struct CameraLead {
  std::string camera;
  double ahead = 0, sigma = 0;  ///< [m] farther ahead in the car than its rig says
};

/// What pairs of images, a second apart, say of the gyroscope and of the cameras' places. Their
/// points alone tell how a camera turned and which way it went, whatever the path says.
struct SensorAgreement {
  double turn_gain = 0, turn_gain_sigma = 1;    ///< share by which the gyroscope turns too far
  double turn_delay = 0, turn_delay_sigma = 1;  ///< [s] by which it is late
  std::vector<CameraLead> leads = {};           ///< of cameras that tell
  /// [m] How far ahead of the rear axle the rig's body lies, as it moves sideways in turns.
  double body_lead = 0, body_lead_sigma = 1e3;
  int num_pairs = 0;
};

/// Compares where the car turned most. Needs the measurements, and a rig with a vehicle: elsewhere,
/// nothing is told.
SensorAgreement MeasureSensorAgreement(const OdometryResult& odometry);

}  // namespace parkade
