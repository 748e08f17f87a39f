#pragma once

#include <string>

#include "server/ingest/schemas/ros_definition.h"

namespace parkade {

/// Whether the text that a log has of a type is IDL and not that of a .msg file.
bool IsIdl(const std::string& text);

/// Reads OMG IDL 4.2 as ROS 2 generates it of messages: structures, arrays, sequences and texts in
/// modules; constants, comments and annotations are passed over. Throws Error{kInvalidInput} where
/// it has something else, or does not define `type` (ROS 1 spelling).
RosDefinition ReadIdlDefinition(const std::string& text, const std::string& type);

}  // namespace parkade
