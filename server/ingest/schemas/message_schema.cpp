#include "server/ingest/schemas/message_schema.h"

#include "core/error.h"

namespace parkade {
namespace {

constexpr int kMaxDepth = 64;  // trees are copied and searched by recursion

class JsonSchema : public MessageSchema {
 public:
  MessageTree Decode(std::span<const std::uint8_t> data) const override {
    const auto is_shallow = [](int depth, MessageTree::parse_event_t, const MessageTree&) {
      Require(depth <= kMaxDepth, ErrorCode::kInvalidInput, "the message is nested too deeply");
      return true;
    };
    MessageTree tree = MessageTree::parse(data.begin(), data.end(), is_shallow,
                                          /*allow_exceptions=*/false);
    Require(!tree.is_discarded(), ErrorCode::kInvalidInput, "the message is not JSON");
    return tree;
  }
};

}  // namespace

std::shared_ptr<const MessageSchema> MakeJsonSchema() {
  return std::make_shared<const JsonSchema>();
}

std::shared_ptr<const MessageSchema> ReadSchema(const TopicInfo& topic) {
  switch (topic.encoding) {
    case MessageEncoding::kProtobuf: return ReadProtobufSchema(topic);
    case MessageEncoding::kJson: return MakeJsonSchema();
    case MessageEncoding::kRos1:
    case MessageEncoding::kCdr: return ReadRosSchema(topic);
    case MessageEncoding::kEuroc: break;
  }
  throw Error(ErrorCode::kInvalidInput, "the messages of " + topic.topic + " have no schema");
}

}  // namespace parkade
