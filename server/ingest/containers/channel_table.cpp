#include "server/ingest/containers/channel_table.h"

#include <string_view>
#include <tuple>

namespace parkade {
namespace {

std::optional<MessageEncoding> EncodingNamed(const std::string& name) {
  if (name == "ros1") return MessageEncoding::kRos1;
  if (name == "cdr") return MessageEncoding::kCdr;
  if (name == "protobuf") return MessageEncoding::kProtobuf;
  if (name == "json") return MessageEncoding::kJson;
  return std::nullopt;
}

}  // namespace

std::optional<int> TopicMap::TopicOf(std::uint32_t channel) const {
  const auto found = topic_of_channel.find(channel);
  if (found == topic_of_channel.end()) return std::nullopt;
  return found->second;
}

TopicMap ChannelTable::MakeTopics(
    const std::map<std::uint32_t, std::uint64_t>& num_messages) const {
  TopicMap map;
  std::map<std::tuple<std::string, std::string, std::string>, int> known;
  for (const auto& [id, channel] : channels_) {
    const std::optional<MessageEncoding> encoding = EncodingNamed(channel.encoding);
    if (!encoding) {
      map.topic_of_channel[id] = -1;
      continue;
    }
    const auto schema = channel.schema ? schemas_.find(*channel.schema) : schemas_.end();
    const std::string type =
        Ros1TypeName(schema != schemas_.end() ? schema->second.type : channel.type);
    const auto [entry, is_new] = known.try_emplace({channel.topic, type, channel.encoding},
                                                   static_cast<int>(map.topics.size()));
    if (is_new)
      map.topics.push_back({channel.topic, type, *encoding, 0,
                            schema != schemas_.end() ? schema->second.text : channel.definition});
    map.topic_of_channel[id] = entry->second;
    const auto count = num_messages.find(id);
    if (count != num_messages.end())
      map.topics[static_cast<std::size_t>(entry->second)].num_messages += count->second;
  }
  return map;
}

std::string Ros1TypeName(const std::string& type) {
  // DDS: "sensor_msgs::msg::dds_::Imu_"
  constexpr std::string_view kDds = "::msg::dds_::";
  const std::size_t dds = type.find(kDds);
  if (dds != std::string::npos && type.ends_with('_'))
    return type.substr(0, dds) + "/" +
           type.substr(dds + kDds.size(), type.size() - dds - kDds.size() - 1);
  const std::size_t middle = type.find("/msg/");
  return middle == std::string::npos ? type : type.substr(0, middle) + type.substr(middle + 4);
}

}  // namespace parkade
