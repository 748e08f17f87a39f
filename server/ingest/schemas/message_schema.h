#pragma once

#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>

#include "server/ingest/containers/raw_message.h"

namespace parkade {

/// A message as a tree of values with names, whatever its encoding: objects, arrays, numbers,
/// texts, and bytes (json::binary). Null: a part that was not sent.
using MessageTree = nlohmann::json;

/// What the bytes of a topic's messages mean. Thread-safe.
class MessageSchema {
 public:
  virtual ~MessageSchema() = default;

  /// Throws Error{kInvalidInput} when the bytes do not hold the message.
  virtual MessageTree Decode(std::span<const std::uint8_t> data) const = 0;
};

/// Reads the schema that the log has of a topic. Throws Error{kInvalidInput} with one sentence
/// where it has none, or one that cannot be read.
std::shared_ptr<const MessageSchema> ReadSchema(const TopicInfo& topic);

// The schemas of each encoding. Throw as ReadSchema.
std::shared_ptr<const MessageSchema> ReadProtobufSchema(const TopicInfo& topic);
/// By the definition that the log has of the type, or else that of a type that is known without
/// (KnownRosDefinition).
std::shared_ptr<const MessageSchema> ReadRosSchema(const TopicInfo& topic);
std::shared_ptr<const MessageSchema> MakeJsonSchema();

}  // namespace parkade
