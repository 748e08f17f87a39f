#include "server/ingest/conversion/convert_log.h"

#include <map>

#include "core/error.h"
#include "core/files/file_error.h"
#include "server/ingest/conversion/clean_log.h"
#include "server/ingest/conversion/clean_message.h"
#include "server/ingest/drive/arrival_merger.h"
#include "server/ingest/drive/recorded_drive_parts.h"
#include "server/ingest/files/temporary_folder.h"
#include "server/ingest/schemas/ros_definition.h"
#include "server/ingest/schemas/translated_source.h"
#include "server/ingest/writing/mcap_writer.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

/// Writes one clean log.
class CleanLogWriter {
 public:
  explicit CleanLogWriter(const fs::path& file)
      : writer_(file, "ros2", {.compression = LogCompression::kZstd}) {}

  void Write(const CleanMessage& message, const SensorStream& stream, Timestamp time) {
    std::string topic = CleanTopic(stream);
    if (message.type == "sensor_msgs/CompressedImage") topic += "/compressed";
    auto channel = channels_.find({topic, message.type});
    if (channel == channels_.end()) channel = AddChannel(topic, message.type);
    writer_.Write(channel->second, time, message.data);
  }

  void Close() { writer_.Close(); }

 private:
  using Channels = std::map<std::pair<std::string, std::string>, int>;

  Channels::iterator AddChannel(const std::string& topic, const std::string& type) {
    std::string ros2_type = type;
    ros2_type.replace(type.find('/'), 1, "/msg/");
    const int channel = writer_.AddChannel(topic, ros2_type, WholeRos2Definition(type), "cdr");
    return channels_.emplace(std::pair(topic, type), channel).first;
  }

  McapWriter writer_;
  Channels channels_;  ///< by topic and type
};

ConvertedDrive WriteDrive(const RecordedDriveParts& drive, const fs::path& file) {
  const std::vector<SensorStream>& streams = drive.survey.streams;
  ArrivalMerger arrivals(std::make_unique<ArrivalStream>(*drive.source, streams,
                                                         std::vector<bool>(streams.size(), true),
                                                         nullptr, drive.survey.stretch),
                         drive.survey.reorder_window);
  CleanLogWriter writer(file);
  ConvertedDrive converted;
  converted.num_left_out = drive.survey.num_left_out;
  TimeSpan span;
  while (const std::optional<Arrival> arrival = arrivals.Next()) {
    const SensorStream& stream = streams[static_cast<std::size_t>(arrival->stream)];
    const std::optional<CleanMessage> message = MakeCleanMessage(*arrival, stream, drive.rig);
    ++(message ? converted.num_messages : converted.num_left_out);
    if (!message) continue;
    writer.Write(*message, stream, arrival->time);
    span.Include(arrival->time);
  }
  writer.Close();
  for (const StreamHealth& health : arrivals.Health())
    converted.num_left_out += health.NumDropped();
  converted.seconds = span.IsEmpty() ? 0 : span.Seconds();
  return converted;
}

/// "NAME.mcap", "NAME_part2.mcap" and so on.
fs::path FileOf(const fs::path& out, std::size_t drive) {
  if (drive == 0) return out;
  return out.parent_path() / (out.stem().string() + "_part" + std::to_string(drive + 1) + ".mcap");
}

void RequireFree(const fs::path& path) {
  std::error_code ignored;
  Require(!fs::exists(fs::symlink_status(path, ignored)), ErrorCode::kInvalidInput,
          "'" + path.string() + "' is there already: choose another --out");
}

fs::path FolderOf(const fs::path& out) {
  return out.has_parent_path() ? out.parent_path() : fs::path(".");
}

fs::path RigOf(const fs::path& out) { return out.parent_path() / (out.stem().string() + "_rig"); }

/// What can be said before the log is read.
void RequirePlace(const fs::path& out) {
  Require(out.extension() == ".mcap" && !out.stem().empty(), ErrorCode::kUsage,
          "--out must be called NAME.mcap");
  Require(fs::is_directory(FolderOf(out)), ErrorCode::kInvalidInput,
          "there is no folder '" + FolderOf(out).string() + "'");
  RequireFree(out);
  RequireFree(RigOf(out));
}

void MoveTo(const fs::path& target, const fs::path& staged) {
  std::error_code error;
  fs::rename(staged, target, error);
  if (error) ThrowErrno("cannot write '" + target.string() + "'", error.value());
}

/// The rig for all drives of a log: of the sensors of which anything is left.
Rig CleanRigOf(const std::vector<std::shared_ptr<RecordedDriveParts>>& drives) {
  std::vector<SensorStream> streams;
  for (const auto& drive : drives)
    for (std::size_t i = 0; i < drive->survey.streams.size(); ++i)
      if (drive->survey.health[i].num_delivered > 0) streams.push_back(drive->survey.streams[i]);
  return CleanRig(drives.front()->rig, streams);
}

}  // namespace

Conversion ConvertLog(const std::shared_ptr<const MessageSource>& source, const fs::path& name,
                      const fs::path& out, const OpenLogOptions& options) {
  const fs::path rig = RigOf(out);
  RequirePlace(out);
  const auto drives = OpenDriveParts(source, name, options);
  for (std::size_t i = 1; i < drives.size(); ++i) RequireFree(FileOf(out, i));

  const TemporaryFolder staging(FolderOf(out));
  const fs::path staged_rig = staging.path() / rig.filename();
  fs::create_directory(staged_rig);
  WriteRig(CleanRigOf(drives), staged_rig);
  Conversion conversion{{}, rig};
  for (std::size_t i = 0; i < drives.size(); ++i) {
    const fs::path file = FileOf(out, i);
    conversion.drives.push_back(WriteDrive(*drives[i], staging.path() / file.filename()));
    conversion.drives.back().file = file;
  }
  MoveTo(rig, staged_rig);
  for (const ConvertedDrive& drive : conversion.drives)
    MoveTo(drive.file, staging.path() / drive.file.filename());
  return conversion;
}

Conversion ConvertLog(const fs::path& log, const fs::path& out, const OpenLogOptions& options) {
  RequirePlace(out);
  return ConvertLog(OpenTranslatedLog(log, options.scratch_folder), log, out, options);
}

}  // namespace parkade
