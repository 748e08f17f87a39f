#include "server/map_folder/site_places.h"

#include <yaml-cpp/yaml.h>

#include "core/error.h"
#include "core/log.h"
#include "core/trajectory.h"
#include "server/map_folder/stage_products.h"
#include "slam/sessions/stage_results.h"

namespace parkade {
namespace {

/// Of the rig that the drive was mapped with; the identity without a vehicle, whose body is the IMU.
Rigid3 ImuFromBody(const std::filesystem::path& calibration) {
  try {
    const YAML::Node vehicle = YAML::LoadFile(calibration)["vehicle"];
    if (!vehicle) return {};
    Eigen::Matrix4d matrix;
    for (int row = 0; row < 4; ++row)
      for (int column = 0; column < 4; ++column) matrix(row, column) = vehicle["T_imu_body"][row][column].as<double>();
    return {Eigen::Quaterniond(matrix.topLeftCorner<3, 3>()).normalized(), matrix.topRightCorner<3, 1>()};
  } catch (const YAML::Exception&) {
    throw Error(ErrorCode::kInvalidInput, calibration.string() + " is not the calibration of a drive");
  }
}

std::vector<Place> ReadPlaces(const FinishedMap& map, const std::string& drive) {
  const std::optional<std::string> bytes = LastProduct(map.FileOfDrive(drive, "places.bin"));
  if (!bytes) return {};
  const Rigid3 imu_from_body = ImuFromBody(map.FileOfDrive(drive, "calibration.yaml"));
  const Trajectory site_from_imu = map.ReadTrajectory(drive);
  std::vector<Place> places;
  for (Place& place : DecodePlaces(*bytes)) {
    const std::optional<Rigid3> pose = site_from_imu.At(place.time);
    if (!pose) continue;
    place.odom_from_place = LevelledPose(*pose * imu_from_body);
    places.push_back(std::move(place));
  }
  return places;
}

}  // namespace

std::vector<std::vector<Place>> ReadSitePlaces(const FinishedMap& map) {
  std::vector<std::vector<Place>> all;
  for (const std::string& drive : map.drives()) {
    if (!map.Has(drive + "/places.bin")) continue;
    try {
      all.push_back(ReadPlaces(map, drive));
    } catch (const Error& error) {
      LogWarning("the places of drive '" + drive + "' cannot be used: " + error.what());
    }
    if (!all.empty() && all.back().empty()) all.pop_back();
  }
  return all;
}

}  // namespace parkade
