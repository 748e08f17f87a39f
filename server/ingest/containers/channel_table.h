#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "server/ingest/containers/raw_message.h"

namespace parkade {

/// Topics of a log and which of the log's channels belong to each.
struct TopicMap {
  std::vector<TopicInfo> topics;  ///< in order of their lowest channel
  std::unordered_map<std::uint32_t, int>
      topic_of_channel;  ///< -1: known, but not of an encoding we read

  /// The topic of a channel: nothing for an unknown channel; -1 where we do not read its encoding.
  std::optional<int> TopicOf(std::uint32_t channel) const;
};

/// The channels that a log defines, gathered in any order: a definition may come after its use.
class ChannelTable {
 public:
  struct Channel {
    std::string topic, type;
    std::string encoding;  ///< "ros1", "cdr", "protobuf", "json", or one we cannot read
    std::optional<std::uint32_t> schema;                      ///< where a schema names the type
    std::shared_ptr<const std::string> definition = nullptr;  ///< of the type, without a schema
  };
  struct Schema {
    std::string type;
    std::shared_ptr<const std::string> text = nullptr;  ///< see TopicInfo::schema
  };

  /// The first definition of an id counts. At most 65536 of each are kept, and 64 MiB of texts.
  void AddSchema(std::uint32_t id, const Schema& schema) {
    Add(schemas_, id, {schema.type, Kept(schema.text)});
  }
  void AddChannel(std::uint32_t id, const Channel& channel) {
    Add(channels_, id,
        {channel.topic, channel.type, channel.encoding, channel.schema, Kept(channel.definition)});
  }
  void AddMissing(const ChannelTable& other) {
    for (const auto& [id, schema] : other.schemas_) AddSchema(id, schema);
    for (const auto& [id, channel] : other.channels_) AddChannel(id, channel);
  }

  bool HasChannel(std::uint32_t id) const { return channels_.contains(id); }
  std::size_t num_channels() const { return channels_.size(); }

  /// Channels of equal topic, type and encoding become one topic. `num_messages` by channel.
  TopicMap MakeTopics(const std::map<std::uint32_t, std::uint64_t>& num_messages) const;

 private:
  template <typename Value>
  static void Add(std::map<std::uint32_t, Value>& table, std::uint32_t id, const Value& value) {
    constexpr std::size_t kMaxSize = 65536;
    if (table.size() < kMaxSize) table.emplace(id, value);
  }

  using Text = std::shared_ptr<const std::string>;
  Text Kept(const Text& text) {
    constexpr std::size_t kMaxBytes = std::size_t{64} << 20;
    if (!text || num_text_bytes_ + text->size() > kMaxBytes) return nullptr;
    num_text_bytes_ += text->size();
    return text;
  }

  std::size_t num_text_bytes_ = 0;
  std::map<std::uint32_t, Schema> schemas_;
  std::map<std::uint32_t, Channel> channels_;
};

/// "sensor_msgs/msg/Imu" and "sensor_msgs/Imu" to "sensor_msgs/Imu".
std::string Ros1TypeName(const std::string& type);

}  // namespace parkade
