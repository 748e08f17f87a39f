#include "server/ingest/schemas/message_schema.h"

#include "core/error.h"
#include "core/files/foreign_json.h"

namespace parkade {
namespace {

class JsonSchema : public MessageSchema {
 public:
  MessageTree Decode(std::span<const std::uint8_t> data) const override {
    MessageTree tree =
        ParseForeignJson(std::string_view(reinterpret_cast<const char*>(data.data()), data.size()));
    Require(!tree.is_discarded(), ErrorCode::kInvalidInput,
            "the message is not JSON, or nested too deeply");
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
