#include <google/protobuf/descriptor.h>
#include <google/protobuf/descriptor.pb.h>
#include <google/protobuf/descriptor_database.h>
#include <google/protobuf/dynamic_message.h>

#include "core/error.h"
#include "server/ingest/schemas/message_schema.h"

namespace parkade {
namespace {

namespace pb = google::protobuf;

/// Keeps what is wrong with a schema from the standard error output: the caller is told.
class Silence : public pb::DescriptorPool::ErrorCollector {
 public:
  void AddError(const std::string&, const std::string&, const pb::Message*, ErrorLocation,
                const std::string&) override {}
};

MessageTree BytesOf(const std::string& text) {
  return MessageTree::binary(std::vector<std::uint8_t>(text.begin(), text.end()));
}

/// Turns one message into a tree. A message of a few bytes may claim to have millions of parts:
/// their number is bounded.
class TreeMaker {
 public:
  MessageTree Make(const pb::Message& message) {
    MessageTree tree = MessageTree::object();
    const pb::Descriptor& type = *message.GetDescriptor();
    for (int i = 0; i < type.field_count(); ++i) {
      const pb::FieldDescriptor& field = *type.field(i);
      tree[field.name()] = field.is_repeated() ? Elements(message, field) : Value(message, field);
    }
    return tree;
  }

 private:
  using Type = pb::FieldDescriptor;

  void Count() {
    constexpr int kMaxParts = 1 << 20;
    Require(++num_parts_ <= kMaxParts, ErrorCode::kInvalidInput, "the message has too many parts");
  }

  MessageTree Value(const pb::Message& message, const pb::FieldDescriptor& field) {
    Count();
    const pb::Reflection& read = *message.GetReflection();
    switch (field.cpp_type()) {
      case Type::CPPTYPE_INT32: return read.GetInt32(message, &field);
      case Type::CPPTYPE_INT64: return read.GetInt64(message, &field);
      case Type::CPPTYPE_UINT32: return read.GetUInt32(message, &field);
      case Type::CPPTYPE_UINT64: return read.GetUInt64(message, &field);
      case Type::CPPTYPE_DOUBLE: return read.GetDouble(message, &field);
      case Type::CPPTYPE_FLOAT: return read.GetFloat(message, &field);
      case Type::CPPTYPE_BOOL: return read.GetBool(message, &field);
      case Type::CPPTYPE_ENUM: return read.GetEnumValue(message, &field);
      case Type::CPPTYPE_STRING: {
        std::string scratch;
        const std::string& text = read.GetStringReference(message, &field, &scratch);
        return field.type() == Type::TYPE_BYTES ? BytesOf(text) : MessageTree(text);
      }
      case Type::CPPTYPE_MESSAGE: break;
    }
    if (!read.HasField(message, &field)) return nullptr;
    return Make(read.GetMessage(message, &field));
  }

  MessageTree Elements(const pb::Message& message, const pb::FieldDescriptor& field) {
    const pb::Reflection& read = *message.GetReflection();
    MessageTree elements = MessageTree::array();
    for (int i = 0; i < read.FieldSize(message, &field); ++i)
      elements.push_back(Element(message, field, i));
    return elements;
  }

  MessageTree Element(const pb::Message& message, const pb::FieldDescriptor& field, int i) {
    Count();
    const pb::Reflection& read = *message.GetReflection();
    switch (field.cpp_type()) {
      case Type::CPPTYPE_INT32: return read.GetRepeatedInt32(message, &field, i);
      case Type::CPPTYPE_INT64: return read.GetRepeatedInt64(message, &field, i);
      case Type::CPPTYPE_UINT32: return read.GetRepeatedUInt32(message, &field, i);
      case Type::CPPTYPE_UINT64: return read.GetRepeatedUInt64(message, &field, i);
      case Type::CPPTYPE_DOUBLE: return read.GetRepeatedDouble(message, &field, i);
      case Type::CPPTYPE_FLOAT: return read.GetRepeatedFloat(message, &field, i);
      case Type::CPPTYPE_BOOL: return read.GetRepeatedBool(message, &field, i);
      case Type::CPPTYPE_ENUM: return read.GetRepeatedEnumValue(message, &field, i);
      case Type::CPPTYPE_STRING: {
        std::string scratch;
        const std::string& text = read.GetRepeatedStringReference(message, &field, i, &scratch);
        return field.type() == Type::TYPE_BYTES ? BytesOf(text) : MessageTree(text);
      }
      case Type::CPPTYPE_MESSAGE: break;
    }
    return Make(read.GetRepeatedMessage(message, &field, i));
  }

  int num_parts_ = 0;
};

class ProtobufSchema : public MessageSchema {
 public:
  /// \param type  of the messages: "foxglove.RawImage"
  ProtobufSchema(const pb::FileDescriptorSet& files, const std::string& type)
      : known_(*pb::DescriptorPool::generated_pool()),
        all_(&own_, &known_),
        pool_(&all_, &silence_) {
    for (const pb::FileDescriptorProto& file : files.file()) own_.Add(file);
    const pb::Descriptor* descriptor = pool_.FindMessageTypeByName(type);
    Require(descriptor != nullptr, ErrorCode::kInvalidInput,
            "the schema of " + type + " does not describe it");
    prototype_ = factory_.GetPrototype(descriptor);
  }

  MessageTree Decode(std::span<const std::uint8_t> data) const override {
    const std::unique_ptr<pb::Message> message(prototype_->New());
    Require(data.size() <= static_cast<std::size_t>(std::numeric_limits<int>::max()) &&
                message->ParsePartialFromArray(data.data(), static_cast<int>(data.size())),
            ErrorCode::kInvalidInput, "the message does not fit its protobuf schema");
    return TreeMaker().Make(*message);
  }

 private:
  Silence silence_;
  pb::SimpleDescriptorDatabase own_;
  pb::DescriptorPoolDatabase
      known_;  ///< google/protobuf/timestamp.proto, where a log leaves it out
  pb::MergedDescriptorDatabase all_;
  pb::DescriptorPool pool_;
  pb::DynamicMessageFactory factory_;
  const pb::Message* prototype_ = nullptr;
};

}  // namespace

std::shared_ptr<const MessageSchema> ReadProtobufSchema(const TopicInfo& topic) {
  pb::FileDescriptorSet files;
  Require(topic.schema && files.ParsePartialFromString(*topic.schema), ErrorCode::kInvalidInput,
          "the protobuf schema of " + topic.topic + " cannot be read");
  const std::string type = topic.native_type.empty() ? topic.type : topic.native_type;
  return std::make_shared<const ProtobufSchema>(files, type);
}

}  // namespace parkade
