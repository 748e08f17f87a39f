#include "server/ingest/containers/kept_source.h"

#include "server/ingest/containers/damage.h"

namespace parkade {
namespace {

struct Unpacked {
  std::shared_ptr<const void> files;
  DamageReport damage;
};

class KeptStream : public MessageStream {
 public:
  KeptStream(std::shared_ptr<const MessageSource> source, const Unpacked& unpacked,
             const std::vector<bool>& wanted)
      : source_(std::move(source)), unpacked_(unpacked), stream_(source_->Read(wanted)) {}

  std::optional<RawMessage> Next() override { return stream_->Next(); }
  const DamageReport& damage() const override {
    damage_ = stream_->damage();
    for (const LostRange& range : unpacked_.damage.ranges) AddLoss(damage_, range);
    damage_.is_truncated |= unpacked_.damage.is_truncated;
    return damage_;
  }

 private:
  std::shared_ptr<const MessageSource> source_;
  Unpacked unpacked_;
  std::unique_ptr<MessageStream> stream_;
  mutable DamageReport damage_;
};

class KeptSource : public MessageSource {
 public:
  KeptSource(std::unique_ptr<MessageSource> source, Unpacked unpacked)
      : source_(std::move(source)), unpacked_(std::move(unpacked)) {}

  const std::vector<TopicInfo>& topics() const override { return source_->topics(); }
  std::string format() const override { return source_->format(); }
  std::unique_ptr<MessageStream> Read(const std::vector<bool>& wanted) const override {
    return std::make_unique<KeptStream>(source_, unpacked_, wanted);
  }
  std::optional<RawMessage> ReadAt(int topic, const MessagePlace& place) const override {
    return source_->ReadAt(topic, place);
  }
  TimeSpan span() const override { return source_->span(); }

 private:
  std::shared_ptr<const MessageSource> source_;
  Unpacked unpacked_;
};

}  // namespace

std::unique_ptr<MessageSource> KeepUnpacked(std::unique_ptr<MessageSource> source,
                                            std::shared_ptr<const void> files,
                                            const DamageReport& damage) {
  return std::make_unique<KeptSource>(std::move(source), Unpacked{std::move(files), damage});
}

}  // namespace parkade
