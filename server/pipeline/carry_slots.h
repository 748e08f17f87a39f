#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "core/ground_markings.h"
#include "core/rigid3.h"
#include "core/trajectory.h"

namespace parkade {

/// A drive whose poses became others: `before` and `after` are of one body, or one IMU.
struct MovedDrive {
  Trajectory before, after;
};

/// How ground moved with the drives that saw it.
struct Carriage {
  Rigid3 after_from_before;
  std::size_t drive = 0;  ///< that passed nearest
  double spread = 0;  ///< [m] by which other passes would have moved the place elsewhere: more than
                      ///< a slot's width says that the ground before was not as it is
};

/// Moves ground at a place [m] as the pose nearest to it has moved; nothing without any pose.
/// O(poses).
std::optional<Carriage> CarryFrom(const Eigen::Vector3d& place, std::span<const MovedDrive> drives);

ParkingSlot Moved(ParkingSlot slot, const Rigid3& after_from_before);

}  // namespace parkade
