#pragma once

#include "tests/simulator/sensors/sensors.h"

namespace parkade::simulator {

/// Integrates an ideal IMU's samples, taken at `rate` [Hz], by the midpoint rule in the rotating
/// frame, from the truth at `start`; returns the distance to the truth [m] after `seconds`.
inline double IntegrationError(const Motion& motion, const Rigid3& body_from_imu, double start,
                               double seconds, double rate) {
  const Timestamp epoch{0};
  const MotionState first = motion.At(start);
  Eigen::Quaterniond rotation = first.world_from_body.rotation * body_from_imu.rotation;
  Eigen::Vector3d position = first.world_from_body * body_from_imu.translation;
  Eigen::Vector3d velocity =
      first.velocity_in_world + first.world_from_body.rotation *
                                    first.angular_velocity_in_body.cross(body_from_imu.translation);
  const double step = 1 / rate;
  for (int i = 0; i < static_cast<int>(seconds * rate); ++i) {
    const ImuSample middle =
        IdealImuSample(motion, body_from_imu, epoch, epoch + (start + (i + 0.5) * step));
    const Eigen::Vector3d acceleration =
        rotation * ExpSo3(middle.angular_velocity * step / 2) * middle.linear_acceleration -
        Eigen::Vector3d(0, 0, kGravity);
    position += velocity * step + 0.5 * step * step * acceleration;
    velocity += step * acceleration;
    rotation = rotation * ExpSo3(middle.angular_velocity * step);
  }
  return (position - motion.WorldFromBody(start + seconds) * body_from_imu.translation).norm();
}

}  // namespace parkade::simulator
