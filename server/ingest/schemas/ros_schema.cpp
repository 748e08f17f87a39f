#include "core/error.h"
#include "server/ingest/messages/message_reader.h"
#include "server/ingest/schemas/idl_definition.h"
#include "server/ingest/schemas/message_schema.h"
#include "server/ingest/schemas/ros_definition.h"

namespace parkade {
namespace {

/// Reads one message by its definition. A message of a few bytes may claim to have millions of
/// parts: their number is bounded.
template <typename Reader>
class Walk {
 public:
  Walk(const RosDefinition& definition, std::span<const std::uint8_t> data)
      : definition_(definition), reader_(data) {}

  MessageTree Message(const std::string& type, int depth) {
    constexpr int kMaxDepth = 24;
    Require(depth < kMaxDepth, ErrorCode::kInvalidInput, "the message definition contains itself");
    const auto found = definition_.types.find(type);
    Require(found != definition_.types.end(), ErrorCode::kInvalidInput,
            "the log does not define " + type);
    MessageTree tree = MessageTree::object();
    for (const RosField& field : found->second) tree[field.name] = Field(field, depth);
    // DDS knows no empty structure.
    if (found->second.empty() && !Reader::kHeaderHasSequence) reader_.template Read<std::uint8_t>();
    return tree;
  }

 private:
  MessageTree Field(const RosField& field, int depth) {
    if (!field.is_array) return Value(field, depth);
    const std::size_t count = field.length ? *field.length : reader_.ReadCount(0);
    if (field.type == "uint8" || field.type == "byte" || field.type == "char") {
      const auto bytes = reader_.ReadBytes(count);
      return MessageTree::binary({bytes.begin(), bytes.end()});
    }
    MessageTree elements = MessageTree::array();
    for (std::size_t i = 0; i < count; ++i) elements.push_back(Value(field, depth));
    return elements;
  }

  MessageTree Value(const RosField& field, int depth) {
    constexpr int kMaxParts = 1 << 20;
    Require(++num_parts_ <= kMaxParts, ErrorCode::kInvalidInput, "the message has too many parts");
    const std::string& type = field.type;
    if (type == "float64") return reader_.template Read<double>();
    if (type == "float32") return reader_.template Read<float>();
    if (type == "bool" || type == "uint8" || type == "char")
      return reader_.template Read<std::uint8_t>();
    if (type == "int8" || type == "byte") return reader_.template Read<std::int8_t>();
    if (type == "int16") return reader_.template Read<std::int16_t>();
    if (type == "uint16") return reader_.template Read<std::uint16_t>();
    if (type == "int32") return reader_.template Read<std::int32_t>();
    if (type == "uint32") return reader_.template Read<std::uint32_t>();
    if (type == "int64") return reader_.template Read<std::int64_t>();
    if (type == "uint64") return reader_.template Read<std::uint64_t>();
    if (type == "string") return std::string(reader_.ReadString());
    if (type == "wstring") {
      reader_.SkipWideString();
      return "";  // texts are names of what Parkade knows
    }
    return Message(type, depth + 1);
  }

  const RosDefinition& definition_;
  Reader reader_;
  int num_parts_ = 0;
};

class RosSchema : public MessageSchema {
 public:
  RosSchema(RosDefinition definition, MessageEncoding encoding)
      : definition_(std::move(definition)), encoding_(encoding) {}

  MessageTree Decode(std::span<const std::uint8_t> data) const override {
    if (encoding_ == MessageEncoding::kRos1)
      return Walk<Ros1Reader>(definition_, data).Message(definition_.main, 0);
    return Walk<CdrReader>(definition_, data).Message(definition_.main, 0);
  }

 private:
  RosDefinition definition_;
  MessageEncoding encoding_;
};

}  // namespace

std::shared_ptr<const MessageSchema> ReadRosSchema(const TopicInfo& topic) {
  const std::string text =
      topic.schema && !topic.schema->empty() ? *topic.schema : KnownRosDefinition(topic.type);
  Require(!text.empty(), ErrorCode::kInvalidInput,
          "the log does not define " + topic.type + ", the type of " + topic.topic);
  RosDefinition definition =
      IsIdl(text) ? ReadIdlDefinition(text, topic.type)
                  : ReadRosDefinition(text, topic.type, topic.encoding == MessageEncoding::kRos1);
  return std::make_shared<const RosSchema>(std::move(definition), topic.encoding);
}

}  // namespace parkade
