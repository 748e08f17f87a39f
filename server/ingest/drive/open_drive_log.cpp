#include "server/ingest/drive/open_drive_log.h"

#include "core/error.h"
#include "core/log.h"
#include "core/parallel.h"
#include "server/ingest/containers/folder_source.h"
#include "server/ingest/drive/clock_plan.h"
#include "server/ingest/drive/file_drive.h"
#include "server/ingest/drive/folder_rig.h"
#include "server/ingest/drive/head_source.h"
#include "server/ingest/drive/log_survey.h"
#include "server/ingest/drive/recorded_drive_parts.h"
#include "server/ingest/drive/rig_discovery.h"
#include "server/ingest/drive/stream_selection.h"
#include "server/ingest/schemas/mapped_source.h"
#include "server/ingest/schemas/translated_source.h"

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

/// Fills in the topics that the rig does not name.
void NameTopics(const std::vector<SensorStream>& streams, Rig& rig) {
  const auto fill_in = [](std::string& topic, const SensorStream& stream) {
    if (topic.empty()) topic = stream.topic_name;
  };
  for (const SensorStream& stream : streams) {
    if (stream.kind == StreamKind::kImu) fill_in(rig.imu.topic, stream);
    if (stream.kind == StreamKind::kImage)
      fill_in(rig.cameras[static_cast<std::size_t>(stream.camera)].topic, stream);
  }
}

int DecodeThreads(const OpenLogOptions& options) {
  return options.num_decode_threads > 0 ? options.num_decode_threads
                                        : std::clamp(NumThreads() - 1, 1, 4);
}

void Append(const std::vector<Finding>& more, std::vector<Finding>& findings) {
  findings.insert(findings.end(), more.begin(), more.end());
}

/// The surveys of the log's stretches, the longest first; what is wrong with its clocks is a
/// finding of that.
std::vector<LogSurvey> SurveyStretches(const MessageSource& source,
                                       std::vector<SensorStream> streams, const Rig& rig) {
  std::vector<LogSurvey> surveys;
  surveys.push_back(SurveyLog(source, streams, rig));
  if (!ClocksMayLeap(surveys.front())) return surveys;
  const ClockPlan plan = PlanClocks(streams, ReadStamps(source, streams));
  if (plan.findings.empty()) return surveys;
  for (std::size_t i = 0; i < streams.size(); ++i) streams[i].clock = plan.runs[i];
  surveys.clear();
  for (int stretch = 0; stretch < plan.num_stretches; ++stretch)
    surveys.push_back(SurveyLog(source, streams, rig, stretch));
  std::stable_sort(surveys.begin(), surveys.end(), [](const LogSurvey& a, const LogSurvey& b) {
    return a.span.Seconds() > b.span.Seconds();
  });
  surveys.front().findings.insert(surveys.front().findings.begin(), plan.findings.begin(),
                                  plan.findings.end());
  return surveys;
}

bool IsUsable(const LogSurvey& survey) {
  return TextsOf(survey.findings, Severity::kUnusable).empty();
}

/// Throws UnusableLog where the beginning of a log shows that all of it is.
void RefuseByBeginning(const std::shared_ptr<const MessageSource>& source, const fs::path& name,
                       OpenLogOptions options) {
  options.warn = false;
  options.keep_survey = {};
  try {
    OpenDriveParts(HeadOf(source, {}), name, options);
  } catch (const UnusableLog& error) {
    if (std::any_of(error.findings().begin(), error.findings().end(), IsLasting)) throw;
  } catch (const Error&) {
    // The rest may hold what the beginning lacks.
  }
}

}  // namespace

Rig FindRig(const MessageSource& source, const fs::path& rig_folder) {
  if (!rig_folder.empty()) return ReadRig(rig_folder);
  if (const auto* files = dynamic_cast<const FolderSource*>(&source.origin()))
    return ReadFolderRig(files->folder());
  return DiscoverRig(source);
}

std::vector<std::shared_ptr<RecordedDriveParts>> OpenDriveParts(
    const std::shared_ptr<const MessageSource>& log, const fs::path& name,
    const OpenLogOptions& options) {
  Rig rig = WithCameras(FindRig(*log, options.rig_folder), options.cameras);
  const std::shared_ptr<const MessageSource> source = MapFields(log, rig);
  StreamSelection selection = SelectStreams(*source, rig, options.use_wheels, options.use_gnss);
  NameTopics(selection.streams, rig);
  const std::string drive = DriveName(name);
  const auto find = [&] {
    std::vector<LogSurvey> surveys = SurveyStretches(*source, selection.streams, rig);
    RequireUsable(surveys.front().findings);
    return EncodeSurveys(std::move(surveys));
  };
  std::vector<LogSurvey> surveys =
      DecodeSurveys(options.keep_survey ? options.keep_survey(drive, find) : find());
  std::vector<std::shared_ptr<RecordedDriveParts>> drives;
  for (LogSurvey& survey : surveys) {
    if (!IsUsable(survey)) continue;
    auto parts = std::make_shared<RecordedDriveParts>();
    parts->source = source;
    parts->rig = rig;
    parts->name = drive;
    if (!drives.empty()) parts->name += "_part" + std::to_string(drives.size() + 1);
    parts->num_decode_threads = DecodeThreads(options);
    parts->health = {survey.health, survey.damage, {}};
    if (drives.empty()) Append(selection.findings, parts->health.findings);
    Append(survey.findings, parts->health.findings);
    parts->survey = std::move(survey);
    for (const std::string& warning : parts->health.Warnings())
      if (options.warn) LogWarning(parts->name + ": " + warning);
    drives.push_back(std::move(parts));
  }
  return drives;
}

std::vector<std::unique_ptr<RecordedDrive>> OpenDriveLogs(
    const std::shared_ptr<const MessageSource>& log, const fs::path& name,
    const OpenLogOptions& options) {
  std::vector<std::unique_ptr<RecordedDrive>> drives;
  for (std::shared_ptr<RecordedDriveParts>& parts : OpenDriveParts(log, name, options))
    drives.push_back(std::make_unique<FileDrive>(std::move(parts)));
  return drives;
}

std::vector<std::unique_ptr<RecordedDrive>> OpenDriveLogs(const fs::path& log,
                                                          const OpenLogOptions& options) {
  const auto source = OpenTranslatedLog(log, options.scratch_folder);
  if (SizeOfLog(log) >= options.large_log) RefuseByBeginning(source, log, options);
  return OpenDriveLogs(source, log, options);
}

std::unique_ptr<RecordedDrive> OpenDriveLog(const fs::path& log, const OpenLogOptions& options) {
  return OpenDriveLog(OpenTranslatedLog(log, options.scratch_folder), log, options);
}

std::unique_ptr<RecordedDrive> OpenDriveLog(const std::shared_ptr<const MessageSource>& source,
                                            const fs::path& name, const OpenLogOptions& options) {
  return std::move(OpenDriveLogs(source, name, options).front());
}

}  // namespace parkade
