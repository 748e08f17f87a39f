#pragma once

#include <vector>

#include "core/rig.h"
#include "server/ingest/checks/image_pairs.h"
#include "server/ingest/checks/speed_history.h"

namespace parkade {

/// What cameras say of a car's speeds and yaw rates, where no wheels do, without the IMU: of each
/// moment with image pairs, the steady motion by which most points stay in their epipolar planes
/// and move away from where the car goes. The rear axle goes where it points. Turning tells the
/// scale of the speed, by the cameras' distances from the axle; straight ahead it is a guess.
///
/// \param pairs  per camera of the rig, whose vehicle is known
SpeedHistory SpeedsByCameras(const Rig& rig, const std::vector<ImagePairs>& pairs);

}  // namespace parkade
