#pragma once

#include <Eigen/Geometry>

#include "core/rig.h"

namespace parkade {

/// The unit direction in which a camera moves, in its axes at the first of two times, when the rear
/// axle follows the chord of an arc.
///
/// \param body_turn  first_from_second of the body
/// \param way        [m] along the chord, negative backward
Eigen::Vector3d WayOfCamera(const RigCamera& camera, const Eigen::Quaterniond& body_turn,
                            double way);

}  // namespace parkade
