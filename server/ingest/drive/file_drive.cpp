#include "server/ingest/drive/file_drive.h"

#include <algorithm>

#include "server/ingest/drive/decode_ahead.h"
#include "server/ingest/drive/recorded_drive_parts.h"
#include "server/ingest/drive/stream_findings.h"

namespace parkade {
namespace {

constexpr std::size_t kMaxDecodedBytes = 64 << 20;

std::vector<bool> WantedStreams(const std::vector<SensorStream>& streams,
                                const ReadOptions& options) {
  std::vector<bool> wanted;
  for (const SensorStream& stream : streams) {
    switch (stream.kind) {
      case StreamKind::kImu: wanted.push_back(options.imu); break;
      case StreamKind::kWheels: wanted.push_back(options.wheels); break;
      case StreamKind::kGnss: wanted.push_back(options.gnss); break;
      case StreamKind::kImage: wanted.push_back(options.images); break;
      case StreamKind::kSemantic: wanted.push_back(options.semantics); break;
    }
  }
  return wanted;
}

DecodeAhead::Limits LimitsOf(const RecordedDriveParts& parts, const ReadOptions& options) {
  std::size_t image_bytes = 1;
  for (const RigCamera& camera : parts.rig.cameras)
    image_bytes = std::max(image_bytes, static_cast<std::size_t>(camera.model.width()) *
                                            static_cast<std::size_t>(camera.model.height()) *
                                            (options.grayscale ? 1 : 3));
  DecodeAhead::Limits limits;
  limits.num_threads = parts.num_decode_threads;
  limits.max_images = std::clamp<std::size_t>(kMaxDecodedBytes / image_bytes, 1, 16);
  return limits;
}

DecodedArrival DecodeArrival(RecordedDriveParts& parts, Arrival arrival, bool grayscale) {
  const SensorStream& stream = parts.survey.streams[static_cast<std::size_t>(arrival.stream)];
  return std::visit(
      [&]<typename Content>(Content& content) -> DecodedArrival {
        if constexpr (!std::is_same_v<Content, EncodedImage>) {
          return {content};
        } else {
          const RigCamera& camera = parts.rig.cameras[static_cast<std::size_t>(stream.camera)];
          const bool is_mask = stream.kind == StreamKind::kSemantic;
          const bool is_intact = parts.intact.Has(arrival.stream, arrival.time);
          const DecodedImage decoded = DecodeEncoded(content, stream,
                                                     {.width = camera.model.width(),
                                                      .height = camera.model.height(),
                                                      .grayscale = grayscale || is_mask,
                                                      .sample_bits = stream.sample_bits,
                                                      .is_intact = is_intact});
          switch (decoded.fault) {
            case ImageFault::kNone: break;
            case ImageFault::kDamaged: return {std::nullopt, DropReason::kDamaged};
            case ImageFault::kWrongSize: return {std::nullopt, DropReason::kWrongSize};
            case ImageFault::kWaitsForKeyFrame:
              return {std::nullopt, DropReason::kWaitsForKeyFrame};
          }
          if (!is_intact) parts.intact.Add(arrival.stream, arrival.time);
          if (is_mask) return {SemanticFrame{arrival.time, stream.camera, decoded.image}};
          return {CameraFrame{arrival.time, stream.camera, decoded.image}};
        }
      },
      arrival.content);
}

/// One pass over the drive. Keeps the parts alive.
class RecordedStream : public RecordStream {
 public:
  RecordedStream(std::shared_ptr<RecordedDriveParts> parts, const ReadOptions& options)
      : parts_(std::move(parts)),
        wanted_(WantedStreams(parts_->survey.streams, options)),
        chooses_images_(options.wants_image != nullptr),
        tally_(wanted_.size()) {
    RecordedDriveParts& drive = *parts_;
    ArrivalStream::Filter filter;
    if (options.wants_image)
      filter = [&drive, wants = options.wants_image](const Arrival& arrival) {
        const bool is_image = std::holds_alternative<EncodedImage>(arrival.content);
        const SensorStream& stream = drive.survey.streams[static_cast<std::size_t>(arrival.stream)];
        return !is_image || wants(stream.camera, arrival.time);
      };
    auto arrivals = std::make_unique<ArrivalStream>(*drive.source, drive.survey.streams, wanted_,
                                                    std::move(filter), drive.survey.stretch);
    auto merger = std::make_unique<ArrivalMerger>(std::move(arrivals), drive.survey.reorder_window);
    const auto decode = [&drive, grayscale = options.grayscale](Arrival arrival) {
      return DecodeArrival(drive, std::move(arrival), grayscale);
    };
    ahead_ = std::make_unique<DecodeAhead>(std::move(merger), decode, LimitsOf(drive, options));
  }

  std::optional<SensorRecord> Next() override {
    while (std::optional<DecodeAhead::Item> item = ahead_->Next()) {
      StreamHealth& tally = tally_[static_cast<std::size_t>(item->stream)];
      if (item->decoded.record) {
        ++tally.num_delivered;
        return std::move(item->decoded.record);
      }
      ++tally.Dropped(item->decoded.reason);
    }
    if (!is_reported_) ReportHealth();
    is_reported_ = true;
    return std::nullopt;
  }

 private:
  void ReportHealth() {
    std::vector<StreamHealth> found = ahead_->source().Health();
    const std::lock_guard lock(parts_->health_mutex);
    for (std::size_t i = 0; i < found.size(); ++i) {
      // Who chose some images does not know how many there are.
      if (!wanted_[i] || (chooses_images_ && parts_->survey.streams[i].camera >= 0)) continue;
      found[i].num_delivered = tally_[i].num_delivered;
      for (std::size_t reason = 0; reason < kNumDropReasons; ++reason)
        found[i].num_dropped[reason] += tally_[i].num_dropped[reason];
      parts_->health.streams[i] = found[i];
    }
    parts_->health.damage = ahead_->source().damage();
  }

  std::shared_ptr<RecordedDriveParts> parts_;
  std::vector<bool> wanted_;
  bool chooses_images_;
  std::vector<StreamHealth> tally_;  ///< delivered, and dropped while decoding
  std::unique_ptr<DecodeAhead> ahead_;
  bool is_reported_ = false;
};

}  // namespace

FileDrive::FileDrive(std::shared_ptr<RecordedDriveParts> parts) : parts_(std::move(parts)) {}

const std::string& FileDrive::name() const { return parts_->name; }
const Rig& FileDrive::rig() const { return parts_->rig; }
TimeSpan FileDrive::span() const { return parts_->survey.span; }

std::unique_ptr<RecordStream> FileDrive::Read(const ReadOptions& options) const {
  return std::make_unique<RecordedStream>(parts_, options);
}

DriveLogHealth FileDrive::health() const {
  const std::lock_guard lock(parts_->health_mutex);
  DriveLogHealth health = parts_->health;
  // What was lost while decoding is known only now.
  for (std::size_t i = 0; i < health.streams.size(); ++i) {
    const SensorStream& stream = parts_->survey.streams[i];
    const bool is_known =
        std::any_of(health.findings.begin(), health.findings.end(),
                    [&](const Finding& finding) { return finding.topic == stream.topic_name; });
    std::optional<Finding> loss = is_known ? std::nullopt : FindLoss(stream, health.streams[i]);
    if (loss) health.findings.push_back(std::move(*loss));
  }
  return health;
}

}  // namespace parkade
