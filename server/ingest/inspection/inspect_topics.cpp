#include "server/ingest/inspection/inspect_topics.h"

#include "core/parallel.h"
#include "server/ingest/drive/stream_selection.h"
#include "server/ingest/messages/image_decoding.h"
#include "server/ingest/messages/message_decoding.h"
#include "server/ingest/video/encoded_image.h"

namespace parkade {
namespace {

/// Decodes images in batches on all cores.
class ImageBatch {
 public:
  ImageBatch(const std::vector<TopicInfo>& topics, std::vector<TopicInspector>& inspectors)
      : topics_(topics),
        inspectors_(inspectors),
        intakes_(topics.size()),
        histories_(topics.size()) {}

  void Add(RawMessage message, Timestamp time) {
    num_bytes_ += message.data.size();
    const auto topic = static_cast<std::size_t>(message.topic);
    const bool is_sampled = histories_[topic].WantsSample(time);
    images_.push_back(
        {intakes_[topic].Take(std::move(message), StreamOf(topic)), topic, time, is_sampled});
    if (images_.size() >= kMaxImages || num_bytes_ >= kMaxBytes) Flush();
  }

  void Flush() {
    const auto found = ParallelMap(images_.size(), [&](std::size_t i) { return Look(images_[i]); });
    for (std::size_t i = 0; i < images_.size(); ++i) {
      const std::size_t topic = images_[i].topic;
      if (found[i].fault.empty()) {
        inspectors_[topic].IncludeImage(images_[i].time, found[i].width, found[i].height);
        histories_[topic].Include(images_[i].time, found[i].glance, found[i].sample);
      } else {
        inspectors_[topic].IncludeFault(images_[i].time, found[i].fault);
      }
    }
    images_.clear();
    num_bytes_ = 0;
  }

  /// The histories by topic; empty where a topic is no camera.
  std::vector<std::vector<CameraFault>> CameraFaults() const {
    std::vector<std::vector<CameraFault>> faults(topics_.size());
    std::vector<std::size_t> cameras;
    std::vector<const ImageHistory*> histories;
    for (std::size_t topic = 0; topic < topics_.size(); ++topic) {
      if (!IsImageType(topics_[topic].type) || IsMaskTopic(topics_[topic].topic)) continue;
      faults[topic] = histories_[topic].Faults();
      cameras.push_back(topic);
      histories.push_back(&histories_[topic]);
    }
    const std::vector<std::vector<CameraFault>> covers = DetectOcclusion(histories);
    for (std::size_t i = 0; i < cameras.size(); ++i)
      faults[cameras[i]].insert(faults[cameras[i]].end(), covers[i].begin(), covers[i].end());
    return faults;
  }

 private:
  static constexpr std::size_t kMaxImages = 64, kMaxBytes = 48 << 20;

  struct Image {
    EncodedImage encoded;
    std::size_t topic = 0;
    Timestamp time;
    bool is_sampled = false;
  };
  struct Found {
    int width = 0, height = 0;
    std::string fault;
    ImageGlance glance;
    std::optional<ImageSample> sample;
  };

  /// Masks of drivable ground are no images: they may well be dark.
  static bool IsMaskTopic(const std::string& topic) {
    return PlainTopic(topic).ends_with("/semantic");
  }

  SensorStream StreamOf(std::size_t topic) const {
    SensorStream stream;
    stream.type = topics_[topic].type;
    stream.encoding = topics_[topic].encoding;
    return stream;
  }

  Found Look(const Image& image) const {
    const SensorStream stream = StreamOf(image.topic);
    DecodedImage decoded = DecodeEncoded(image.encoded, stream, {});
    if (decoded.fault != ImageFault::kNone) return {0, 0, decoded.what, {}, {}};
    // Perhaps only 12 of 16 bits are in use: an image is not dark for that.
    if (const std::optional<int> bits = SampleBits(image.encoded.message, stream))
      decoded = DecodeEncoded(image.encoded, stream, {.sample_bits = *bits});
    Found found{decoded.image.cols, decoded.image.rows, "", {}, {}};
    if (IsMaskTopic(topics_[image.topic].topic)) return found;
    found.glance = GlanceAt(decoded.image);
    if (image.is_sampled) found.sample = SampleOf(decoded.image);
    return found;
  }

  const std::vector<TopicInfo>& topics_;
  std::vector<TopicInspector>& inspectors_;
  std::vector<ImageIntake> intakes_;     // by topic
  std::vector<ImageHistory> histories_;  // by topic
  std::vector<Image> images_;
  std::size_t num_bytes_ = 0;
};

}  // namespace

void InspectTopics(const MessageSource& source, LogInspection& inspection,
                   std::uint64_t max_images) {
  const std::vector<TopicInfo>& topics = source.topics();
  std::vector<TopicInspector> inspectors(topics.begin(), topics.end());
  ImageBatch images(topics, inspectors);
  std::vector<std::uint64_t> num_images(topics.size());
  const auto stream = source.Read(std::vector<bool>(topics.size(), true));
  while (std::optional<RawMessage> message = stream->Next()) {
    const auto index = static_cast<std::size_t>(message->topic);
    inspectors[index].IncludeMessage(*message);
    if (IsImageType(topics[index].type) && ++num_images[index] <= max_images)
      images.Add(std::move(*message), inspectors[index].last_stamp());
  }
  images.Flush();
  for (const TopicInspector& inspector : inspectors)
    inspection.topics.push_back(inspector.Finish());
  const std::vector<std::vector<CameraFault>> image_faults = images.CameraFaults();
  for (std::size_t i = 0; i < topics.size(); ++i)
    inspection.topics[i].image_faults = image_faults[i];
  inspection.damage = stream->damage();
  if (!inspection.span.IsEmpty()) return;  // that of a drive
  for (const TopicInspection& topic : inspection.topics) {
    if (topic.span.IsEmpty()) continue;
    inspection.span.Include(topic.span.begin);
    inspection.span.Include(topic.span.end);
  }
}

}  // namespace parkade
