#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/drive_log.h"
#include "core/rig.h"
#include "core/rigid3.h"

namespace parkade {

/// One of the recorded clips in `shared/data`, as far as the front end needs it.
struct RealClip {
  std::vector<RigCamera> cameras;             ///< body = imu
  std::vector<std::vector<Timestamp>> times;  ///< per camera
  std::vector<std::vector<std::filesystem::path>> images;
  std::vector<ImuSample> imu;

  CameraFrame Frame(size_t camera, size_t index) const;

  /// Camera-frame rotation between two times, from the gyro: p_to = R p_from.
  Eigen::Matrix3d Rotation(size_t camera, Timestamp from, Timestamp to) const;
};

/// Folder of the third-party data: $PARKADE_SHARED_DATA, otherwise
/// ../shared/data beside the repository. Nothing where `name` is not there.
std::optional<std::filesystem::path> FindSharedData(const std::string& name);

/// Cells of a CSV file, lines with '#' left out.
std::vector<std::vector<std::string>> ReadCsv(const std::filesystem::path& file);

std::optional<RealClip> LoadKittiClip();    ///< a car, stereo, 51 pairs at 9.66 Hz, 12 m/s
std::optional<RealClip> LoadEurocStill();   ///< a drone on the ground, stereo, 95 pairs at 20 Hz
std::optional<RealClip> LoadEurocFlight();  ///< a drone in the air, left camera, 90 images at 20 Hz

}  // namespace parkade
