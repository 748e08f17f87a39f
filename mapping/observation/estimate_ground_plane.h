#pragma once

#include <optional>
#include <span>

#include "core/landmark.h"
#include "core/rig.h"
#include "core/trajectory.h"

namespace parkade {

/// The frame `ground` of a rig: z = 0 on the road under the car, x forward, origin below the
/// body's. It is the body frame where vehicle.yaml tells it. Otherwise the plane is found in the
/// landmarks: each is seen from a few of the body's poses nearby, so that the road under a car
/// stands still there while the car drives; then RANSAC (PCL) for a plane that gravity allows,
/// below the cameras and with next to nothing under it. Nothing where no such plane exists: too few
/// landmarks, or a body that rolls and pitches like a drone's.
std::optional<Rigid3> EstimateBodyFromGround(const Rig& rig, const Trajectory& odom_from_body,
                                             std::span<const Landmark> landmarks);

}  // namespace parkade
