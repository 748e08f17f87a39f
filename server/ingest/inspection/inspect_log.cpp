#include "server/ingest/inspection/inspect_log.h"

#include <algorithm>
#include <functional>

#include "core/error.h"
#include "server/ingest/drive/first_look.h"
#include "server/ingest/drive/head_source.h"
#include "server/ingest/drive/open_drive_log.h"
#include "server/ingest/inspection/inspect_topics.h"
#include "server/ingest/messages/message_decoding.h"
#include "server/ingest/schemas/mapped_source.h"
#include "server/ingest/schemas/translated_source.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

std::uint64_t NumGood(const LogInspection& inspection,
                      const std::function<bool(const std::string&)>& is_type) {
  std::uint64_t count = 0;
  for (const TopicInspection& topic : inspection.topics)
    if (is_type(topic.type))
      count += topic.num_messages - std::min(topic.num_messages, topic.num_undecodable);
  return count;
}

/// The log with what the rig's field map finds in it; as it is where that does not fit, which
/// opening the drive says.
std::shared_ptr<const MessageSource> WithMappedTopics(
    const std::shared_ptr<const MessageSource>& source, const fs::path& rig_folder) {
  if (rig_folder.empty()) return source;
  try {
    Rig rig = ReadRig(rig_folder);
    return MapFields(source, rig);
  } catch (const Error&) {
    return source;
  }
}

/// Opens the drive for what a map would say of the log. `state` is unusable where it would say that
/// there is none, for all that the log or its owner brings.
void TryToOpen(const std::shared_ptr<const MessageSource>& source, const fs::path& rig_folder,
               LogInspection& inspection) {
  try {
    OpenLogOptions options;
    options.rig_folder = rig_folder;
    options.warn = false;
    const auto drive = OpenDriveLog(source, inspection.name, options);
    inspection.rig = drive->rig();
    inspection.span = drive->span();
    inspection.findings = drive->health().findings;
  } catch (const UnusableLog& error) {
    inspection.missing.push_back(error.what());
    inspection.findings = error.findings();
    inspection.state = LogState::kUnusable;
  } catch (const Error& error) {
    inspection.missing.push_back(error.what());
    // A log may yet get the rig that it lacks.
    if (!rig_folder.empty()) inspection.state = LogState::kUnusable;
  }
}

/// After the topics have been looked at.
LogState StateOf(const LogInspection& inspection) {
  const bool has_imu =
      NumGood(inspection, [](const std::string& type) { return type == "sensor_msgs/Imu"; }) > 0;
  const bool has_images = NumGood(inspection, IsImageType) > 0;
  if (!has_imu || !has_images || inspection.state == LogState::kUnusable)
    return LogState::kUnusable;
  bool is_clean =
      inspection.damage.IsClean() && TextsOf(inspection.findings, Severity::kWarning).empty();
  for (const TopicInspection& topic : inspection.topics)
    is_clean = is_clean && topic.NumLost() == 0;
  return is_clean ? LogState::kClean : LogState::kLossy;
}

/// Whether a log has no topic of a type, or no message by its index.
bool LacksType(const MessageSource& source,
               const std::function<bool(const std::string&)>& is_type) {
  const std::vector<TopicInfo>& topics = source.topics();
  const bool has_index = std::any_of(topics.begin(), topics.end(),
                                     [](const TopicInfo& topic) { return topic.num_messages > 0; });
  return std::none_of(topics.begin(), topics.end(), [&](const TopicInfo& topic) {
    return is_type(topic.type) && (topic.num_messages > 0 || !has_index);
  });
}

/// Whether many images came of each topic of images, and none could be decoded.
bool AreImagesHopeless(const LogInspection& inspection) {
  constexpr std::uint64_t kMany = 50;
  return std::all_of(inspection.topics.begin(), inspection.topics.end(),
                     [](const TopicInspection& topic) {
                       return !IsImageType(topic.type) ||
                              (topic.num_messages >= kMany && topic.num_undecodable >= kMany);
                     });
}

/// Looks at the beginning of a log, whether it shows that the log is unusable.
bool IsHopeless(const std::shared_ptr<const MessageSource>& source, const fs::path& rig_folder,
                LogInspection& inspection) {
  constexpr std::uint64_t kMaxImages = 60;  // of each topic
  const auto beginning = HeadOf(source, {});
  inspection.is_of_beginning = true;
  InspectTopics(*WithMappedTopics(beginning, rig_folder), inspection, kMaxImages);
  TryToOpen(beginning, rig_folder, inspection);
  // An IMU may also come from a field map.
  const bool lacks_imu = rig_folder.empty() && LacksType(*source, [](const std::string& type) {
                           return type == "sensor_msgs/Imu";
                         });
  const bool is_hopeless =
      lacks_imu || LacksType(*source, IsImageType) || AreImagesHopeless(inspection) ||
      std::any_of(inspection.findings.begin(), inspection.findings.end(), IsLasting);
  inspection.state = LogState::kUnusable;
  return is_hopeless;
}

}  // namespace

LogInspection InspectLog(const fs::path& log, const fs::path& rig_folder,
                         const fs::path& scratch_folder, std::uint64_t large_log) {
  const std::shared_ptr<const MessageSource> source = OpenTranslatedLog(log, scratch_folder);
  LogInspection inspection;
  inspection.name = log.filename().string();
  inspection.format = source->format();
  inspection.num_bytes = SizeOfLog(log);
  const bool is_large = inspection.num_bytes >= large_log;
  if (is_large) {
    LogInspection beginning = inspection;
    if (IsHopeless(source, rig_folder, beginning)) return beginning;
  }
  TryToOpen(source, rig_folder, inspection);
  const bool is_read_in_part = is_large && inspection.state == LogState::kUnusable;
  inspection.is_of_beginning = is_read_in_part;
  const auto part = is_read_in_part ? HeadOf(source, {}) : source;
  InspectTopics(*WithMappedTopics(part, rig_folder), inspection);
  inspection.state = StateOf(inspection);
  return inspection;
}

}  // namespace parkade
