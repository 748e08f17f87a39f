#include "server/ingest/drive/log_survey.h"

#include <algorithm>

#include "core/error.h"
#include "server/ingest/drive/arrival_stream.h"
#include "server/ingest/messages/image_decoding.h"

namespace parkade {
namespace {

constexpr double kMaxReorderWindow = 2;  // [s]

/// Looks at the images of one camera as they pass.
class ImageSurvey {
 public:
  void Include(const RawMessage& message, const SensorStream& stream, const RigCamera& camera) {
    if (const std::optional<int> bits = SampleBits(message, stream))
      sample_bits_ = std::max(sample_bits_, *bits);
    if (is_size_checked_ || stream.kind != StreamKind::kImage) return;
    const ImageRequest request{.width = camera.model.width(), .height = camera.model.height()};
    const DecodedImage decoded = DecodeMessageImage(message, stream, request);
    Require(decoded.fault != ImageFault::kWrongSize, ErrorCode::kInvalidInput,
            "the rig does not fit the log: camera " + camera.name + ": " + decoded.what);
    is_size_checked_ = decoded.fault == ImageFault::kNone;
  }

  int sample_bits() const { return sample_bits_ > 0 ? sample_bits_ : 16; }

 private:
  bool is_size_checked_ = false;
  int sample_bits_ = 0;
};

void RequireUsable(const LogSurvey& survey) {
  std::uint64_t num_images = 0;
  std::uint64_t num_dropped_images = 0;
  for (std::size_t i = 0; i < survey.streams.size(); ++i) {
    const StreamHealth& health = survey.health[i];
    const StreamKind kind = survey.streams[i].kind;
    Require(kind != StreamKind::kImu || health.num_delivered > 0, ErrorCode::kInvalidInput,
            "the IMU topic " + health.topic + " has no usable sample");
    if (kind != StreamKind::kImage) continue;
    num_images += health.num_delivered;
    num_dropped_images += health.NumDropped();
  }
  Require(num_images > 0, ErrorCode::kInvalidInput,
          num_dropped_images == 0
              ? "the log has no image of any camera of the rig"
              : "no image of the log can be used: all " + std::to_string(num_dropped_images) +
                    " are damaged or their stamps are not on the IMU's clock");
}

}  // namespace

LogSurvey SurveyLog(const MessageSource& source, std::vector<SensorStream> streams,
                    const Rig& rig) {
  LogSurvey survey;
  survey.streams = std::move(streams);
  ArrivalStream arrivals(source, survey.streams, std::vector<bool>(survey.streams.size(), true),
                         nullptr);
  std::vector<ImageSurvey> images(survey.streams.size());
  std::optional<Timestamp> front;
  while (const std::optional<Arrival> arrival = arrivals.Next()) {
    const auto index = static_cast<std::size_t>(arrival->stream);
    survey.span.Include(arrival->time);
    front = front ? std::max(*front, arrival->time) : arrival->time;
    const double lag = *front - arrival->time;
    if (lag <= kMaxReorderWindow) survey.reorder_window = std::max(survey.reorder_window, lag);
    if (const auto* image = std::get_if<EncodedImage>(&arrival->content)) {
      const SensorStream& stream = survey.streams[index];
      images[index].Include(image->message, stream,
                            rig.cameras[static_cast<std::size_t>(stream.camera)]);
    }
  }
  for (std::size_t i = 0; i < survey.streams.size(); ++i) {
    SensorStream& stream = survey.streams[i];
    stream.sample_bits = images[i].sample_bits();
    if (stream.kind != StreamKind::kWheels || !arrivals.HasWheelsWithOnlyPoses()) continue;
    stream.is_speed_from_pose = true;
    survey.warnings.push_back("the twist of " + stream.topic_name +
                              " is always zero: speed is taken from its pose");
    // A speed from two poses belongs midway between them, later than the survey saw it come.
    survey.reorder_window = std::min(kMaxReorderWindow, survey.reorder_window + 0.25);
  }
  survey.health = arrivals.health();
  survey.damage = arrivals.damage();
  RequireUsable(survey);
  return survey;
}

}  // namespace parkade
