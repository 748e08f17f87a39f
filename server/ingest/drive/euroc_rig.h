#pragma once

#include <filesystem>

#include "core/rig.h"

namespace parkade {

/// The rig of an EuRoC folder from the sensor.yaml of its imu0 and cam0, cam1, ... Models: pinhole
/// with radial-tangential (radtan), equidistant or no distortion. T_BS is body_from_sensor; where
/// odom0 exists, EuRoC's body is taken for the car's (docs/conventions.md), else `vehicle` stays
/// empty. Throws Error{kInvalidInput} naming the file and the key that is missing or wrong.
Rig ReadEurocRig(const std::filesystem::path& folder);

}  // namespace parkade
