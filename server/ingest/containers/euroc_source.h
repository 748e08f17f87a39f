#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/ingest/containers/raw_message.h"
#include "server/ingest/files/temporary_folder.h"

namespace parkade {

/// The EuRoC folder (the one that holds imu0/, cam0/, ...) in `folder`: itself, its child mav0, or
/// the only such one at most three levels down. Nothing when there is none; throws
/// Error{kInvalidInput} when there are several.
std::optional<std::filesystem::path> FindEurocFolder(const std::filesystem::path& folder);

/// A drive in EuRoC/ASL layout as a source of messages. Topics: "imu0", "odom0", "gnss0", "cam0",
/// "cam0/semantic",
/// ... with the ROS types whose meaning they have, encoded as kEuroc. Messages are in order of
/// their stamps; one whose stamp is out of line with its neighbors stays at its place in its file.
class EurocSource : public MessageSource {
 public:
  /// `folder` as FindEurocFolder gives it. Throws Error{kInvalidInput} when it holds no stream.
  explicit EurocSource(const std::filesystem::path& folder);

  /// A folder that was unpacked from an archive, whose `damage` (one phrase, or empty) every pass
  /// reports.
  EurocSource(std::shared_ptr<const TemporaryFolder> unpacked, const std::string& damage);

  const std::vector<TopicInfo>& topics() const override { return topics_; }
  std::string format() const override { return unpacked_ ? "EuRoC archive" : "EuRoC folder"; }
  std::unique_ptr<MessageStream> Read(const std::vector<bool>& wanted) const override;
  std::optional<RawMessage> ReadAt(int topic, const MessagePlace& place) const override;

  const std::filesystem::path& folder() const { return folder_; }
  const std::string& archive_damage() const { return archive_damage_; }

 private:
  std::shared_ptr<const TemporaryFolder> unpacked_;
  std::string archive_damage_;
  std::filesystem::path folder_;
  std::vector<TopicInfo> topics_;
};

}  // namespace parkade
