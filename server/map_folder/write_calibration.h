#pragma once

#include <filesystem>
#include <vector>

#include "core/rig.h"
#include "slam/odometry/odometry_result.h"

namespace parkade {

/// Writes the rig as one YAML file in Kalibr's keys: `cam0` ... `camN` as in
/// camchain-imucam.yaml, `imu0` and `vehicle` as in their files. Each has a `status`,
/// "refined" or "kept"; a camera also has `calibration`: per quantity its own status,
/// what was changed and sigma, as in OdometryReport. Whole or not at all.
///
/// \param calibration  of the cameras in `rig`, in their order; empty: all were kept
void WriteCalibration(const Rig& rig, const std::vector<CameraCalibration>& calibration,
                      const std::filesystem::path& file);

}  // namespace parkade
