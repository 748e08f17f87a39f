#pragma once

#include <Eigen/Core>
#include <functional>

#include "core/rigid3.h"

namespace parkade {

/// Exact motion of a body at one instant. World: z up.
struct BodyMotion {
  Rigid3 world_from_body;
  Eigen::Vector3d velocity;              ///< [m/s] in world
  Eigen::Vector3d acceleration;          ///< [m/s^2] in world
  Eigen::Vector3d angular_velocity;      ///< [rad/s] in body
  Eigen::Vector3d angular_acceleration;  ///< [rad/s^2] in body
};

using MotionFunction = std::function<BodyMotion(double seconds)>;

/// A car park on wheels: stands for 2 s, drives left and right turns at up to
/// 5 m/s, takes a ramp, stops for 4 s, reverses, and begins anew every 50 s. The rear
/// axle never slips sideways. Twice differentiable. `seconds` may be negative: it
/// stands. Values are exact to 1e-9.
MotionFunction CarMotion(double duration);

/// A drone in a room of 8 x 8 x 4 m: sums of sines in all six degrees of freedom,
/// up to 1.5 m/s, moving from the first instant.
MotionFunction FlightMotion();

/// On a circle in the plane at constant `speed` [m/s] and `yaw_rate` [rad/s], from the origin.
MotionFunction BendMotion(double speed, double yaw_rate);

/// Standing still for good at the origin.
MotionFunction RestingMotion();

}  // namespace parkade
