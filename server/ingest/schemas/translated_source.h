#pragma once

#include <filesystem>
#include <memory>

#include "server/ingest/containers/raw_message.h"

namespace parkade {

/// The same log with messages of Foxglove's types, in protobuf, JSON or as `foxglove_msgs`, as ROS
/// messages (CDR); the topic's `native_type` says what they were. Other topics in protobuf and JSON
/// stay as they are,
/// their type followed by the encoding: "my.Imu (protobuf)". A topic whose schema cannot be read
/// counts as one of those. A message that does not fit its schema becomes an empty one, which no
/// decoder takes. The source itself where it has no such topics.
std::shared_ptr<const MessageSource> TranslateSource(std::shared_ptr<const MessageSource> source);

/// TranslateSource of OpenLogSource (open_log_source.h), and throws as that.
std::shared_ptr<const MessageSource> OpenTranslatedLog(const std::filesystem::path& log,
                                                       const std::filesystem::path& scratch_folder);

}  // namespace parkade
