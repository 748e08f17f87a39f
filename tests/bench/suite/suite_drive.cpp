#include "tests/bench/suite/suite_drive.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/files/file.h"
#include "server/ingest/drive/open_drive_log.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTruthFolder = "truth";

fs::path LogFile(const fs::path& drive) {
  for (const char* name : {"drive.mcap", "drive.bag", "drive"})
    if (fs::exists(drive / name)) return drive / name;
  throw Error(ErrorCode::kNotFound, "no drive log in " + drive.filename().string());
}

/// Faults of the record; an error of the rig or of its stamps is not one of them.
std::vector<std::string> FaultsOf(const nlohmann::json& summary) {
  std::vector<std::string> faults;
  for (const auto& [name, value] : summary.at("faults").at("asked_for").items())
    if (!name.starts_with("extrinsic_") && name != "time_offsets") faults.push_back(name);
  return faults;
}

}  // namespace

std::vector<std::string> ListSuite(const fs::path& suite) {
  Require(fs::is_directory(suite), ErrorCode::kNotFound,
          "there is no folder '" + suite.filename().string() + "'");
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(suite))
    if (fs::exists(entry.path() / kTruthFolder / "summary.json"))
      names.push_back(entry.path().filename().string());
  std::erase_if(names, [](const std::string& name) { return name.ends_with(".part"); });
  std::sort(names.begin(), names.end());
  return names;
}

SuiteDrive OpenSuiteDrive(const fs::path& suite, const std::string& name) {
  const fs::path folder = suite / name, truth = folder / kTruthFolder;
  const nlohmann::json summary = nlohmann::json::parse(ReadFile(truth / "summary.json"));
  SuiteDrive drive;
  drive.name = name;
  drive.scene = summary.at("options").at("scene").get<std::string>();
  drive.faults = FaultsOf(summary);
  OpenLogOptions open;
  open.rig_folder = truth / "rig_true";
  open.warn = false;
  drive.log = OpenDriveLog(LogFile(folder), open);
  drive.nominal_rig = ReadRig(truth / "rig");
  drive.true_rig = drive.log->rig();
  const fs::path knocked = truth / "rig_true_knocked";
  drive.true_rig_at_end = fs::exists(knocked) ? ReadRig(knocked) : drive.true_rig;
  drive.world_from_imu = ReadTum(truth / "truth.tum");
  return drive;
}

std::vector<Eigen::Vector3d> PathOf(const Trajectory& trajectory) {
  std::vector<Eigen::Vector3d> path;
  for (const TrajectoryState& state : trajectory.states())
    if (path.empty() || (state.world_from_body.translation - path.back()).norm() > 0.2)
      path.push_back(state.world_from_body.translation);
  return path;
}

}  // namespace parkade
