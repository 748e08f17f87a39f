#include "server/ingest/open_drive_log.h"

#include "core/error.h"
#include "core/log.h"
#include "core/parallel.h"
#include "server/ingest/euroc_rig.h"
#include "server/ingest/euroc_source.h"
#include "server/ingest/log_survey.h"
#include "server/ingest/recorded_drive_parts.h"
#include "server/ingest/stream_selection.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

/// The rig with only the cameras named, in the order named.
Rig WithCameras(Rig rig, const std::vector<std::string>& names) {
  if (names.empty()) return rig;
  std::vector<RigCamera> chosen;
  for (const std::string& name : names) {
    const auto found = std::find_if(rig.cameras.begin(), rig.cameras.end(),
                                    [&](const RigCamera& camera) { return camera.name == name; });
    std::vector<std::string> known;
    for (const RigCamera& camera : rig.cameras) known.push_back(camera.name);
    Require(found != rig.cameras.end(), ErrorCode::kInvalidInput,
            "the rig has no camera " + name + ", it has " + ListTopics(known));
    chosen.push_back(*found);
  }
  rig.cameras = std::move(chosen);
  ValidateRig(rig);
  return rig;
}

/// Letters, digits, '-', '_' and '.' of the log's name without its extension.
std::string DriveName(const fs::path& log) {
  fs::path path = fs::absolute(log).lexically_normal();
  if (path.filename().empty()) path = path.parent_path();
  if (path.filename() == "mav0") path = path.parent_path();
  std::string name = fs::is_directory(path) ? path.filename().string() : path.stem().string();
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '-' && c != '_' && c != '.') c = '_';
  return name.empty() ? "drive" : name;
}

int DecodeThreads(const OpenLogOptions& options) {
  return options.num_decode_threads > 0 ? options.num_decode_threads : std::clamp(NumThreads() - 1, 1, 4);
}

}  // namespace

std::unique_ptr<RecordedDrive> OpenDriveLog(const fs::path& log, const OpenLogOptions& options) {
  Require(fs::exists(log), ErrorCode::kNotFound, "there is no log " + log.filename().string());
  auto parts = std::make_shared<RecordedDriveParts>();
  const std::optional<fs::path> euroc = fs::is_directory(log) ? FindEurocFolder(log) : std::nullopt;
  Require(euroc.has_value(), ErrorCode::kInvalidInput, log.filename().string() + " is not a drive log");
  parts->source = std::make_shared<EurocSource>(*euroc);
  Rig rig = options.rig_folder.empty() ? ReadEurocRig(*euroc) : ReadRig(options.rig_folder);
  parts->rig = WithCameras(std::move(rig), options.cameras);
  parts->name = DriveName(log);
  parts->num_decode_threads = DecodeThreads(options);
  StreamSelection selection = SelectStreams(*parts->source, parts->rig, options.use_wheels, options.use_gnss);
  parts->survey = SurveyLog(*parts->source, std::move(selection.streams), parts->rig);
  parts->health = {parts->survey.health, parts->survey.damage, std::move(selection.warnings)};
  for (const std::string& warning : parts->survey.warnings) parts->health.warnings.push_back(warning);
  for (const std::string& warning : parts->health.warnings) LogWarning(parts->name + ": " + warning);
  return std::make_unique<RecordedDrive>(std::move(parts));
}

}  // namespace parkade
