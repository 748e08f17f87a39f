#pragma once

#include <optional>
#include <vector>

#include "core/trajectory.h"

namespace parkade {

/// Chooses the images worth mapping: per camera one for every stretch of travel, none at standstill but the
/// first. Decides by the pose alone, before anything is decoded. Ask in order of time per camera; asking again
/// for the time just chosen (its mask) answers the same. Not thread-safe.
class KeyframePicker {
 public:
  /// The trajectory is borrowed.
  KeyframePicker(const Trajectory& odom_from_body, size_t num_cameras, double min_distance, double min_angle);

  /// False outside the trajectory.
  bool Wants(int camera, Timestamp time);

 private:
  struct Choice {
    Timestamp time;
    Rigid3 odom_from_body;
  };
  const Trajectory* odom_from_body_;
  double min_distance_;  ///< [m]
  double min_angle_;     ///< [rad]
  std::vector<std::optional<Choice>> last_choices_;
};

}  // namespace parkade
