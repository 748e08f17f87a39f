#include "server/map_folder/site_keyframes.h"

#include <yaml-cpp/yaml.h>

#include "core/error.h"
#include "core/log.h"
#include "core/trajectory.h"
#include "server/map_folder/stage_cache.h"
#include "slam/places/keyframe_bytes.h"

namespace parkade {
namespace {

/// imu_from_body of the rig that the drive was mapped with; the identity without a vehicle, whose
/// body is the IMU.
Rigid3 ImuFromBody(const std::filesystem::path& calibration) {
  try {
    const YAML::Node vehicle = YAML::LoadFile(calibration)["vehicle"];
    if (!vehicle) return {};
    Eigen::Matrix4d matrix;
    for (int row = 0; row < 4; ++row)
      for (int column = 0; column < 4; ++column)
        matrix(row, column) = vehicle["T_imu_body"][row][column].as<double>();
    return {Eigen::Quaterniond(matrix.topLeftCorner<3, 3>()).normalized(),
            matrix.topRightCorner<3, 1>()};
  } catch (const YAML::Exception&) {
    throw Error(ErrorCode::kInvalidInput,
                calibration.string() + " is not the calibration of a drive");
  }
}

std::vector<RigKeyframe> ReadKeyframes(const MapReader& map, const std::string& drive) {
  const std::optional<std::string> bytes = LastProduct(map.FileOfDrive(drive, "places.bin"));
  if (!bytes) return {};
  const Rigid3 imu_from_body = ImuFromBody(map.FileOfDrive(drive, "calibration.yaml"));
  const Trajectory site_from_imu = map.ReadTrajectory(drive);
  std::vector<RigKeyframe> keyframes;
  for (RigKeyframe& keyframe : DecodeKeyframes(*bytes)) {
    const std::optional<Rigid3> pose = site_from_imu.At(keyframe.time);
    if (!pose) continue;
    keyframe.odom_from_keyframe = LeveledPose(*pose * imu_from_body);
    keyframes.push_back(std::move(keyframe));
  }
  return keyframes;
}

}  // namespace

std::vector<std::vector<RigKeyframe>> ReadSiteKeyframes(const MapReader& map) {
  std::vector<std::vector<RigKeyframe>> all;
  for (const std::string& drive : map.drives()) {
    if (!map.Has(drive + "/places.bin")) continue;
    try {
      all.push_back(ReadKeyframes(map, drive));
    } catch (const Error& error) {
      LogWarning("the places of drive '" + drive + "' cannot be used: " + error.what());
    }
    if (!all.empty() && all.back().empty()) all.pop_back();
  }
  return all;
}

}  // namespace parkade
