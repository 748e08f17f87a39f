#pragma once

#include <cstdint>
#include <map>
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
    std::string encoding;                 ///< "ros1", "cdr", or one we cannot read
    std::optional<std::uint32_t> schema;  ///< where the type is named by a schema
  };

  /// The first definition of an id counts. At most 65536 of each are kept.
  void AddSchema(std::uint32_t id, const std::string& type) { Add(schemas_, id, type); }
  void AddChannel(std::uint32_t id, const Channel& channel) { Add(channels_, id, channel); }
  void AddMissing(const ChannelTable& other) {
    for (const auto& [id, type] : other.schemas_) AddSchema(id, type);
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

  std::map<std::uint32_t, std::string> schemas_;
  std::map<std::uint32_t, Channel> channels_;
};

/// "sensor_msgs/msg/Imu" and "sensor_msgs/Imu" to "sensor_msgs/Imu".
std::string Ros1TypeName(const std::string& type);

}  // namespace parkade
