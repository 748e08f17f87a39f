#pragma once

#include "server/ingest/schemas/message_schema.h"
#include "server/ingest/schemas/ros_definition.h"

namespace parkade {

/// Reads the definition that a log of ROS has of a topic's type, or that of a type that is known
/// without (KnownRosDefinition). Throws as ReadSchema.
std::shared_ptr<const MessageSchema> ReadRosSchema(const TopicInfo& topic);

}  // namespace parkade
