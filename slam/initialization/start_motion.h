#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/rig.h"
#include "slam/factors/motion_state.h"
#include "slam/factors/sample_buffer.h"
#include "slam/initialization/gyroscope_bias.h"
#include "slam/tracking/feature_track.h"

namespace parkade {

enum class StartKind { kStandstill, kRollingOnWheels, kMovingInImages };

std::string ToText(StartKind kind);

/// State at one instant from nothing but the sensors around it.
struct StartEstimate {
  StartKind kind = StartKind::kStandstill;
  MotionState state;
  StartUncertainty uncertainty;
};

/// All functions: `begin` < `end` lie within the IMU's span; the state is that at `begin`,
/// position zero, x axis of the IMU heading along x of odom; nothing when the
/// data does not determine it.

/// The car stands: bias is the mean rotation rate, down the mean force.
std::optional<StartEstimate> StartFromStandstill(const ImuBuffer& imu,
                                                 const ImuCalibration& calibration, Timestamp begin,
                                                 Timestamp end);

/// The car rolls: velocity from the wheels, down from what the accelerometer feels
/// beyond the wheels' acceleration. `bias` of the gyroscope may come from images.
std::optional<StartEstimate> StartFromWheels(const ImuBuffer& imu, const WheelBuffer& wheels,
                                             const Rig& rig, const GyroscopeBiasEstimate& bias,
                                             Timestamp begin, Timestamp end);

/// No wheels: velocity, gravity and biases that make the rays of all tracks,
/// of all cameras, meet, adjusted from several hypotheses of the speed. Scale comes
/// from the accelerometer, from the distance between cameras that see the same, and
/// from the height of the cameras above the ground where the rig knows that.
/// The unknowns are those of A. Martinelli, "Closed-Form Solution of Visual-Inertial
/// Structure from Motion", IJCV 2014; its linear solution is not used: it minimizes
/// distances across rays, which are smallest where everything is near and slow.
std::optional<StartEstimate> StartFromImages(const ImuBuffer& imu,
                                             const std::vector<TrackedFrame>& frames,
                                             const Rig& rig, const GyroscopeBiasEstimate& bias,
                                             Timestamp begin, Timestamp end);

/// odom_from_imu with `gravity_in_imu` pointing down and the IMU's x axis heading
/// along x of odom.
Eigen::Quaterniond LeveledRotation(const Eigen::Vector3d& gravity_in_imu);

}  // namespace parkade
