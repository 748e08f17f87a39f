#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/ingest/schemas/message_schema.h"

namespace parkade {

// Foxglove's types (docs.foxglove.dev, "Message schemas"), which logs hold as protobuf, JSON or ROS
// messages of their own, as the ROS messages that say the same.

/// The ROS type for "foxglove.RawImage", "foxglove_msgs/RawImage" and the like; empty for others.
std::string RosTypeFor(const std::string& type);

/// The ROS message in CDR. `type` is one of those that RosTypeFor knows. A stamp that is missing
/// becomes 0. Throws Error{kInvalidInput} where the data cannot be read.
std::vector<std::uint8_t> ToRosMessage(const MessageTree& message, const std::string& type);

}  // namespace parkade
