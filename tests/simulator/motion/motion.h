#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "core/rigid3.h"

namespace parkade::simulator {

/// Position and attitude as plain numbers: x, y, z [m] of body in world, then
/// yaw, pitch, roll [rad] with world_from_body = Rz(yaw) Ry(pitch) Rx(roll).
using PoseVector = Eigen::Matrix<double, 6, 1>;

/// Everything about the car's motion at one instant, exact.
struct MotionState {
  Rigid3 world_from_body;
  Eigen::Vector3d velocity_in_world;             ///< [m/s] of the body origin
  Eigen::Vector3d acceleration_in_world;         ///< [m/s^2]
  Eigen::Vector3d angular_velocity_in_body;      ///< [rad/s]
  Eigen::Vector3d angular_acceleration_in_body;  ///< [rad/s^2]
};

/// What the body does over time: a quintic B-spline of the six pose numbers, so
/// that images, IMU, wheels and truth all come from one function that is
/// differentiable four times. It is the truth by definition; it approximates the
/// function it is made from to fourth order of the node distance.
class Motion {
 public:
  /// Samples `pose_at` every `node_distance` [s] over [0, duration].
  Motion(const std::function<PoseVector(double)>& pose_at, double duration,
         double node_distance = 0.02);

  double Duration() const { return duration_; }  ///< [s]
  MotionState At(double time) const;             ///< `time` is clamped to [0, duration]
  Rigid3 WorldFromBody(double time) const;

 private:
  double duration_ = 0;
  double node_distance_ = 0;
  std::vector<PoseVector> control_points_;
};

}  // namespace parkade::simulator
