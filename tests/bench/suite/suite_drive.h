#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/drive_log.h"
#include "core/trajectory.h"

namespace parkade {

/// One drive of a folder that `parkade-simulate suite` filled, with its truth.
struct SuiteDrive {
  std::string name;                 ///< of the preset
  std::string scene;                ///< "lot", "street", "garage"
  std::vector<std::string> faults;  ///< that were asked for besides the rig's errors
  std::unique_ptr<DriveLog> log;    ///< with the true rig
  Rig nominal_rig;                  ///< as the owner of the car knows it
  Rig true_rig;                     ///< as it is when the drive begins
  Rig true_rig_at_end;              ///< another one where a mirror was knocked
  std::vector<TimedPose> world_from_imu;

  bool is_garage() const { return scene == "garage"; }
};

/// Names of the finished drives of a suite's folder, in order of the alphabet.
std::vector<std::string> ListSuite(const std::filesystem::path& suite);

/// Opens a drive. Throws Error where something of it is missing.
SuiteDrive OpenSuiteDrive(const std::filesystem::path& suite, const std::string& name);

/// Points [m] of a drive, 0.2 m apart: what is judged lies near them.
std::vector<Eigen::Vector3d> PathOf(const Trajectory& trajectory);

}  // namespace parkade
