#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "server/ingest/containers/raw_message.h"
#include "server/ingest/files/drive_folder.h"
#include "server/ingest/files/temporary_folder.h"

namespace parkade {

/// A drive in a folder of files as a source of messages. Topics: "imu0", "odom0", "gnss0", "cam0",
/// "cam0/semantic", ... with the ROS types whose meaning they have, encoded as kEuroc. Messages are
/// in order of their stamps; one whose stamp is out of line with its neighbors stays at its place
/// in its file.
class FolderSource : public MessageSource {
 public:
  /// `folder` as FindDriveFolder gives it. Throws Error{kInvalidInput} when it holds no stream.
  explicit FolderSource(DriveFolder folder);

  /// A folder that was unpacked from the archive `name`, whose `damage` (one phrase, or empty)
  /// every pass reports. Throws also when it holds several drives.
  FolderSource(std::shared_ptr<const TemporaryFolder> unpacked, const std::string& name,
               const std::string& damage);

  const std::vector<TopicInfo>& topics() const override { return topics_; }
  std::string format() const override;
  std::unique_ptr<MessageStream> Read(const std::vector<bool>& wanted) const override;
  std::optional<RawMessage> ReadAt(int topic, const MessagePlace& place) const override;

  const DriveFolder& folder() const { return folder_; }
  const std::vector<FolderStream>& streams() const { return streams_; }  ///< as topics()
  const std::string& archive_damage() const { return archive_damage_; }

 private:
  std::shared_ptr<const TemporaryFolder> unpacked_;
  std::string archive_damage_;
  DriveFolder folder_;
  std::vector<FolderStream> streams_;
  std::vector<TopicInfo> topics_;
};

}  // namespace parkade
