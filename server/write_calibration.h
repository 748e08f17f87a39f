#pragma once

#include <filesystem>

#include "core/rig.h"

namespace parkade {

/// Writes the rig as one YAML file in Kalibr's keys: `cam0` ... `camN` as in
/// camchain-imucam.yaml, `imu0` and `vehicle` as in their files, and `status`:
/// "kept" for each of them, as this version refines none. Whole or not at all.
void WriteCalibration(const Rig& rig, const std::filesystem::path& file);

}  // namespace parkade
