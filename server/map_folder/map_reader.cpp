#include "server/map_folder/map_reader.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "mapping/mesh/read_ply.h"
#include "server/map_folder/odometry_fingerprint.h"
#include "server/map_folder/report_file.h"
#include "server/map_folder/surface_file.h"

namespace parkade {
namespace {

using Json = nlohmann::json;

std::string Join(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

/// JSON has no infinity: the sigma of a height about which nothing is known is null.
double ReadSigma(const Json& sigma) {
  return sigma.is_null() ? std::numeric_limits<double>::infinity() : sigma.get<double>();
}

/// Sigma of where the map's corner lies that is farthest from where it is placed.
Eigen::Vector3d SigmaOf(const Json& georeference, const Json& bounds) {
  Eigen::Vector3d sigma;
  double reach = 0;
  for (size_t i = 0; i < 3; ++i) {
    sigma[static_cast<Eigen::Index>(i)] = ReadSigma(georeference.at("position_sigma").at(i));
    if (i < 2)
      reach = std::hypot(reach, 0.5 * (bounds.at("max").at(i).get<double>() -
                                       bounds.at("min").at(i).get<double>()));
  }
  const double turned = reach * ReadSigma(georeference.at("yaw_sigma"));
  return {std::hypot(sigma.x(), turned), std::hypot(sigma.y(), turned), sigma.z()};
}

}  // namespace

MapReader::MapReader(const std::filesystem::path& folder) : folder_(folder) {
  Require(std::filesystem::is_directory(folder), ErrorCode::kNotFound,
          folder.string() + " is not a folder");
  Require(std::filesystem::exists(folder / "report.json"), ErrorCode::kInvalidInput,
          folder.string() + " holds no map: it has no report.json");
  try {
    const Json report = ReadReport(folder);
    for (const Json& drive : report.at("drives")) {
      drives_.push_back(drive.at("name").get<std::string>());
      Remember(report, drive);
    }
    for (const Json& drive : report.value("left_out", Json::array()))
      if (drive.contains("streams")) Remember(report, drive);
    if (const auto join = report.find("join"); join != report.end() && join->contains("review"))
      link_review_ = {.rejected = join->at("review").at("rejected"),
                      .forced = join->at("review").at("forced")};
    if (const Json& datum = report.at("datum"); !datum.is_null())
      datum_ = SiteDatum{.latitude_deg = datum.at("latitude_deg").get<double>(),
                         .longitude_deg = datum.at("longitude_deg").get<double>(),
                         .altitude = datum.at("altitude").get<double>(),
                         .is_altitude_known = datum.value("is_altitude_known", true)};
    if (const auto placed = report.find("georeference");
        placed != report.end() && placed->contains("position_sigma"))
      placement_sigma_ = SigmaOf(*placed, report.at("bounds"));
  } catch (const Json::exception&) {
    throw Error(ErrorCode::kInvalidInput,
                (folder / "report.json").string() + " is not the report of a map");
  }
}

void MapReader::Remember(const Json& report, const Json& drive) {
  const auto name = drive.at("name").get<std::string>();
  if (const auto log = drive.find("log"); log != drive.end())
    logs_[name] = log->value("sha256", "");
  tracked_by_[name] = parkade::OdometryFingerprint(report.value("options", Json::object()),
                                                   drive.value("streams", Json::array()));
  if (const auto loops = drive.find("loops"); loops != drive.end() && loops->contains("review"))
    reviews_[name] = {.rejected = loops->at("review").at("rejected"),
                      .forced = loops->at("review").at("forced")};
}

bool MapReader::Holds(const std::string& drive, const std::string& log) const {
  return std::find(drives_.begin(), drives_.end(), drive) != drives_.end() && MayBeOf(drive, log);
}

bool MapReader::Holds(const std::string& drive, const LogHashes& logs) const {
  const auto log = logs.find(drive);
  return Holds(drive, log == logs.end() ? std::string() : log->second);
}

bool MapReader::MayBeOf(const std::string& drive, const std::string& log) const {
  const std::string own = LogOf(drive);
  return own.empty() || log.empty() || own == log;
}

std::string MapReader::LogOf(const std::string& drive) const {
  const auto found = logs_.find(drive);
  return found == logs_.end() ? "" : found->second;
}

std::string MapReader::OdometryFingerprint(const std::string& drive) const {
  const auto found = tracked_by_.find(drive);
  return found == tracked_by_.end() ? "" : found->second;
}

LoopReview MapReader::ReviewOf(const std::string& drive) const {
  const auto found = reviews_.find(drive);
  return found == reviews_.end() ? LoopReview{} : found->second;
}

std::filesystem::path MapReader::FileNamed(const std::string& name) const {
  std::filesystem::path file = folder_ / name;
  Require(std::filesystem::exists(file), ErrorCode::kInvalidInput,
          "the map in " + folder_.string() + " has no " + name +
              (datum_ ? ""
                      : " (it is not georeferenced: some files are only there with GNSS or pins)"));
  return file;
}

std::filesystem::path MapReader::FileOfDrive(const std::string& drive,
                                             const std::string& name) const {
  Require(!drive.empty() || drives_.size() == 1, ErrorCode::kUsage,
          "the map has several drives (" + Join(drives_) + "): choose one by --drive");
  const std::string chosen = drive.empty() ? drives_.front() : drive;
  Require(std::find(drives_.begin(), drives_.end(), chosen) != drives_.end(), ErrorCode::kUsage,
          "the map has no drive '" + chosen + "', but: " + Join(drives_));
  return FileNamed(chosen + "/" + name);
}

TriangleMesh MapReader::ReadGround() const { return ReadPly(FileNamed("ground.ply")); }

Trajectory MapReader::ReadTrajectory(const std::string& drive) const {
  std::vector<TrajectoryState> states;
  for (const TimedPose& pose : ReadTum(FileOfDrive(drive, "trajectory.tum")))
    states.push_back({.time = pose.time, .world_from_body = pose.world_from_frame});
  return Trajectory(std::move(states));
}

SurfaceMap MapReader::ReadSurfaceMap() const {
  const std::filesystem::path file = folder_ / "surface.bin";
  Require(std::filesystem::exists(file), ErrorCode::kInvalidInput,
          "the map in " + folder_.string() +
              " has no surface.bin: an older version of this program made it");
  return ReadSurface(file);
}

}  // namespace parkade
