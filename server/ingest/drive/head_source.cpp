#include "server/ingest/drive/head_source.h"

namespace parkade {
namespace {

class HeadStream : public MessageStream {
 public:
  HeadStream(std::unique_ptr<MessageStream> stream, const HeadLimits& limits)
      : stream_(std::move(stream)), limits_(limits) {}

  std::optional<RawMessage> Next() override {
    if (is_over_) return std::nullopt;
    std::optional<RawMessage> message = stream_->Next();
    if (!message) return std::nullopt;
    span_.Include(message->log_time);
    num_bytes_ += message->data.size();
    is_over_ = span_.Seconds() > limits_.seconds ||
               (num_bytes_ > limits_.num_bytes && span_.Seconds() > limits_.min_seconds);
    return message;
  }
  const DamageReport& damage() const override { return stream_->damage(); }

 private:
  std::unique_ptr<MessageStream> stream_;
  HeadLimits limits_;
  TimeSpan span_;
  std::uint64_t num_bytes_ = 0;
  bool is_over_ = false;
};

class HeadSource : public MessageSource {
 public:
  HeadSource(std::shared_ptr<const MessageSource> source, const HeadLimits& limits)
      : source_(std::move(source)), limits_(limits) {}

  const std::vector<TopicInfo>& topics() const override { return source_->topics(); }
  std::string format() const override { return source_->format(); }
  std::unique_ptr<MessageStream> Read(const std::vector<bool>& wanted) const override {
    return std::make_unique<HeadStream>(source_->Read(wanted), limits_);
  }
  std::optional<RawMessage> ReadAt(int topic, const MessagePlace& place) const override {
    return source_->ReadAt(topic, place);
  }
  const MessageSource& origin() const override { return source_->origin(); }

 private:
  std::shared_ptr<const MessageSource> source_;
  HeadLimits limits_;
};

}  // namespace

std::shared_ptr<const MessageSource> HeadOf(std::shared_ptr<const MessageSource> source,
                                            const HeadLimits& limits) {
  return std::make_shared<const HeadSource>(std::move(source), limits);
}

}  // namespace parkade
