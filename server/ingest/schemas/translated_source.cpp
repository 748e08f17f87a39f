#include "server/ingest/schemas/translated_source.h"

#include <algorithm>

#include "core/error.h"
#include "server/ingest/containers/open_log_source.h"
#include "server/ingest/messages/message_decoding.h"
#include "server/ingest/schemas/foxglove_messages.h"
#include "server/ingest/schemas/message_schema.h"

namespace parkade {
namespace {

bool IsInForeignEncoding(const TopicInfo& topic) {
  return topic.encoding == MessageEncoding::kProtobuf || topic.encoding == MessageEncoding::kJson;
}

/// Whether ROS messages are of a type that has a twin which decoders know.
bool IsForeignType(const std::string& type) {
  return type.starts_with("foxglove_msgs/") && !IsImageType(type) && !RosTypeFor(type).empty();
}

bool IsForeign(const TopicInfo& topic) {
  return IsInForeignEncoding(topic) || IsForeignType(topic.type);
}

/// What is done with the messages of one topic.
struct TopicTranslation {
  std::shared_ptr<const MessageSchema> schema;  ///< null: nothing
  std::string native_type;

  void Apply(RawMessage& message) const {
    if (!schema) return;
    try {
      message.data = ToRosMessage(schema->Decode(message.data), native_type);
    } catch (const Error&) {
      message.data.clear();
    }
  }
};

/// The translation of a foreign topic, which becomes what it is then.
TopicTranslation TranslateTopic(TopicInfo& topic) {
  const std::string native_type = topic.type;
  const std::string ros_type = RosTypeFor(native_type);
  try {
    if (!ros_type.empty()) {
      TopicTranslation translation{ReadSchema(topic), native_type};
      topic.type = ros_type;
      topic.encoding = MessageEncoding::kCdr;
      topic.native_type = native_type;
      topic.schema = nullptr;
      return translation;
    }
  } catch (const Error&) {  // said by its type
  }
  if (!IsInForeignEncoding(topic)) return {};
  topic.native_type = native_type;
  topic.type += topic.encoding == MessageEncoding::kJson ? " (JSON)" : " (protobuf)";
  return {};
}

using Translations = std::vector<TopicTranslation>;

class TranslatedStream : public MessageStream {
 public:
  TranslatedStream(std::unique_ptr<MessageStream> stream,
                   std::shared_ptr<const Translations> translations)
      : stream_(std::move(stream)), translations_(std::move(translations)) {}

  std::optional<RawMessage> Next() override {
    std::optional<RawMessage> message = stream_->Next();
    if (message) (*translations_)[static_cast<std::size_t>(message->topic)].Apply(*message);
    return message;
  }
  const DamageReport& damage() const override { return stream_->damage(); }

 private:
  std::unique_ptr<MessageStream> stream_;
  std::shared_ptr<const Translations> translations_;
};

class TranslatedSource : public MessageSource {
 public:
  explicit TranslatedSource(std::shared_ptr<const MessageSource> source)
      : source_(std::move(source)), topics_(source_->topics()) {
    Translations translations(topics_.size());
    for (std::size_t i = 0; i < topics_.size(); ++i)
      if (IsForeign(topics_[i])) translations[i] = TranslateTopic(topics_[i]);
    translations_ = std::make_shared<const Translations>(std::move(translations));
  }

  const std::vector<TopicInfo>& topics() const override { return topics_; }
  std::string format() const override { return source_->format(); }
  std::unique_ptr<MessageStream> Read(const std::vector<bool>& wanted) const override {
    return std::make_unique<TranslatedStream>(source_->Read(wanted), translations_);
  }
  std::optional<RawMessage> ReadAt(int topic, const MessagePlace& place) const override {
    std::optional<RawMessage> message = source_->ReadAt(topic, place);
    if (message) (*translations_)[static_cast<std::size_t>(topic)].Apply(*message);
    return message;
  }

 private:
  std::shared_ptr<const MessageSource> source_;
  std::vector<TopicInfo> topics_;
  std::shared_ptr<const Translations> translations_;
};

}  // namespace

std::shared_ptr<const MessageSource> TranslateSource(std::shared_ptr<const MessageSource> source) {
  if (std::ranges::none_of(source->topics(), IsForeign)) return source;
  return std::make_shared<const TranslatedSource>(std::move(source));
}

std::shared_ptr<const MessageSource> OpenTranslatedLog(
    const std::filesystem::path& log, const std::filesystem::path& scratch_folder) {
  return TranslateSource(OpenLogSource(log, scratch_folder));
}

}  // namespace parkade
