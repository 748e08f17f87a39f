#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/rig.h"

namespace parkade {

inline constexpr const char* kCameraChainFile = "camchain-imucam.yaml";
inline constexpr const char* kImuFile = "imu0.yaml";
inline constexpr const char* kBasaltFile = "calibration.json";

/// The files of a rig, by their names in its folder; empty where there is none.
struct RigFileNames {
  std::string camera_chain, imu;
  std::string basalt;  ///< cameras and IMU in one
};

/// Finds a rig's files among the names of a folder's: those of the usual names, else the one that
/// is called as Kalibr calls its results (`BAG-camchain-imucam.yaml`, `BAG-imu.yaml`, and before
/// 2021 `camchain-imucam-BAG.yaml`, `imu-BAG.yaml`). A chain with the IMU goes before one without
/// (`BAG-camchain.yaml`). Basalt calls its file `calibration.json` or `NAME_calib.json`. Throws
/// Error{kInvalidInput} where there are several of one kind.
RigFileNames FindRigFiles(const std::vector<std::string>& names);

/// Reads a rig as ReadRig does, for who needs its cameras alone: the IMU's file may be missing.
/// Then the IMU has the noise of no particular one. Throws as ReadRig.
Rig ReadCameraRig(const std::filesystem::path& folder);

}  // namespace parkade
