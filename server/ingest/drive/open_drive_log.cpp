#include "server/ingest/drive/open_drive_log.h"

#include "core/error.h"
#include "core/log.h"
#include "core/parallel.h"
#include "server/ingest/containers/euroc_source.h"
#include "server/ingest/containers/open_log_source.h"
#include "server/ingest/drive/euroc_rig.h"
#include "server/ingest/drive/file_drive.h"
#include "server/ingest/drive/log_survey.h"
#include "server/ingest/drive/recorded_drive_parts.h"
#include "server/ingest/drive/rig_discovery.h"
#include "server/ingest/drive/stream_selection.h"

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

/// Whether a folder of this name may lie in a map: not hidden, not taken by one of its own files.
bool IsNameOfDrive(const std::string& name) {
  if (name.empty() || name.front() == '.' || name == "tiles") return false;
  const auto ends_so = [&](const char* extension) { return name.ends_with(extension); };
  const auto of_files = {".json", ".geojson", ".glb", ".ply", ".png", ".pgw", ".tif", ".bin"};
  return std::none_of(of_files.begin(), of_files.end(), ends_so);
}

/// The drive's name: letters, digits, '-', '_' and '.' of the log's name without its extension.
std::string DriveName(const fs::path& log) {
  fs::path path = fs::absolute(log).lexically_normal();
  if (path.filename().empty()) path = path.parent_path();
  if (path.filename() == "mav0") path = path.parent_path();
  std::string name = fs::is_directory(path) ? path.filename().string() : path.stem().string();
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '-' && c != '_' && c != '.') c = '_';
  return IsNameOfDrive(name) ? name : "drive" + name;
}

int DecodeThreads(const OpenLogOptions& options) {
  return options.num_decode_threads > 0 ? options.num_decode_threads
                                        : std::clamp(NumThreads() - 1, 1, 4);
}

}  // namespace

Rig FindRig(const MessageSource& source, const fs::path& rig_folder) {
  if (!rig_folder.empty()) return ReadRig(rig_folder);
  if (const auto* euroc = dynamic_cast<const EurocSource*>(&source))
    return ReadEurocRig(euroc->folder());
  return DiscoverRig(source);
}

std::unique_ptr<RecordedDrive> OpenDriveLog(const fs::path& log, const OpenLogOptions& options) {
  return OpenDriveLog(OpenLogSource(log, options.scratch_folder), log, options);
}

std::unique_ptr<RecordedDrive> OpenDriveLog(std::shared_ptr<const MessageSource> source,
                                            const fs::path& name, const OpenLogOptions& options) {
  auto parts = std::make_shared<RecordedDriveParts>();
  parts->source = std::move(source);
  parts->rig = WithCameras(FindRig(*parts->source, options.rig_folder), options.cameras);
  parts->name = DriveName(name);
  parts->num_decode_threads = DecodeThreads(options);
  StreamSelection selection =
      SelectStreams(*parts->source, parts->rig, options.use_wheels, options.use_gnss);
  parts->survey = SurveyLog(*parts->source, std::move(selection.streams), parts->rig);
  parts->health = {parts->survey.health, parts->survey.damage, std::move(selection.warnings)};
  for (const std::string& warning : parts->survey.warnings)
    parts->health.warnings.push_back(warning);
  for (const std::string& warning : parts->health.warnings)
    if (options.warn) LogWarning(parts->name + ": " + warning);
  return std::make_unique<FileDrive>(std::move(parts));
}

}  // namespace parkade
