#include "server/ingest/drive/log_survey.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "core/binary_serialization.h"
#include "core/error.h"
#include "core/files/binary_archive.h"
#include "server/ingest/checks/gyroscope_findings.h"
#include "server/ingest/checks/imu_checks.h"
#include "server/ingest/checks/log_checks.h"
#include "server/ingest/drive/arrival_stream.h"
#include "server/ingest/drive/coverage_findings.h"
#include "server/ingest/drive/stream_findings.h"
#include "server/ingest/messages/image_decoding.h"

namespace parkade {

template <typename Archive>
void Serialize(Archive& archive, TimeSpan& span) {
  archive(span.begin, span.end);
}

template <typename Archive>
void Serialize(Archive& archive, ClockRun& run) {
  archive(run.begin, run.correction, run.stretch);
}

template <typename Archive>
void Serialize(Archive& archive, SensorStream& stream) {
  archive(stream.kind, stream.topic, stream.camera, stream.role, stream.topic_name, stream.type,
          stream.encoding, stream.time_shift, stream.stuck, stream.clock, stream.acceleration_scale,
          stream.rate_scale, stream.speed_scale, stream.is_speed_from_pose, stream.sample_bits);
}

template <typename Archive>
void Serialize(Archive& archive, StreamHealth& health) {
  archive(health.topic, health.role, health.num_delivered, health.num_dropped, health.off_clock_by,
          health.span, health.longest_gap, health.longest_gap_begin);
}

template <typename Archive>
void Serialize(Archive& archive, LostRange& range) {
  archive(range.what, range.topic, range.time, range.num_messages);
}

template <typename Archive>
void Serialize(Archive& archive, DamageReport& damage) {
  archive(damage.ranges, damage.num_lost_messages, damage.is_truncated);
}

template <typename Archive>
void Serialize(Archive& archive, Finding& finding) {
  archive(finding.name, finding.severity, finding.topic, finding.sentence, finding.advice,
          finding.evidence);
}

template <typename Archive>
void Serialize(Archive& archive, LogSurvey& survey) {
  archive(survey.span, survey.reorder_window, survey.streams, survey.health, survey.damage,
          survey.findings, survey.stretch, survey.num_left_out);
}

namespace {

constexpr double kMaxReorderWindow = 2;  // [s]

/// Looks at the images of one camera as they pass.
class ImageSurvey {
 public:
  void Include(const EncodedImage& image, const SensorStream& stream, const RigCamera& camera) {
    if (const std::optional<int> bits = SampleBits(image.message, stream))
      sample_bits_ = std::max(sample_bits_, *bits);
    if (is_size_checked_ || num_tried_ == kMaxTries || stream.kind != StreamKind::kImage) return;
    ++num_tried_;
    const ImageRequest request{.width = camera.model.width(), .height = camera.model.height()};
    const DecodedImage decoded = DecodeEncoded(image, stream, request);
    Require(decoded.fault != ImageFault::kWrongSize, ErrorCode::kInvalidInput,
            "the rig does not fit the log: camera " + camera.name + ": " + decoded.what);
    is_size_checked_ = decoded.fault == ImageFault::kNone;
    fault_ = is_size_checked_ ? "" : decoded.what;
  }

  int sample_bits() const { return sample_bits_ > 0 ? sample_bits_ : 16; }
  /// Why no image can be decoded; empty where one can, or none came.
  const std::string& fault() const { return fault_; }

 private:
  static constexpr int kMaxTries = 400;  // a whole minute of damage

  bool is_size_checked_ = false;
  int num_tried_ = 0;
  int sample_bits_ = 0;
  std::string fault_;
};

/// One of a video is decoded at once: later it would need those before it again.
UndecodedImage Undecoded(EncodedImage image, const SensorStream& stream, const RigCamera& camera) {
  const ImageRequest request{.width = camera.model.width(),
                             .height = camera.model.height(),
                             .grayscale = true,
                             .sample_bits = stream.sample_bits};
  const auto decode = [&stream, request](const EncodedImage& encoded) {
    const DecodedImage decoded = DecodeEncoded(encoded, stream, request);
    return decoded.fault == ImageFault::kNone ? decoded.image : cv::Mat();
  };
  if (image.track) {
    cv::Mat decoded = decode(image);
    return {[decoded] { return decoded; }, decoded.total()};
  }
  const std::size_t num_bytes = image.message.data.size();
  return {[decode, image = std::move(image)] { return decode(image); }, num_bytes};
}

/// Takes streams out of the survey.
void LeaveOut(const std::function<bool(const SensorStream&)>& is_meant, LogSurvey& survey) {
  for (std::size_t i = survey.streams.size(); i-- > 0;) {
    if (!is_meant(survey.streams[i])) continue;
    survey.num_left_out += survey.health[i].num_delivered + survey.health[i].NumDropped();
    survey.streams.erase(survey.streams.begin() + static_cast<std::ptrdiff_t>(i));
    survey.health.erase(survey.health.begin() + static_cast<std::ptrdiff_t>(i));
  }
}

/// The index of the camera whose images have the topic.
int CameraOf(const std::string& topic, const std::vector<SensorStream>& streams) {
  const auto found = std::find_if(streams.begin(), streams.end(), [&](const SensorStream& stream) {
    return stream.kind == StreamKind::kImage && stream.topic_name == topic;
  });
  return found->camera;
}

void Add(const std::vector<Finding>& findings, LogSurvey& survey) {
  survey.findings.insert(survey.findings.end(), findings.begin(), findings.end());
}

/// Corrects a stream's readings and stamps as a finding about them says.
void Correct(const Finding& finding, const LogChecks& checks, SensorStream& stream) {
  if (finding.name == kCamerasLate && stream.camera >= 0)
    stream.time_shift -= finding.evidence.at(kDelay);
  if (finding.topic != stream.topic_name) return;
  if (finding.name == kImuGain && finding.evidence.contains(kGainCorrection))
    stream.acceleration_scale *= finding.evidence.at(kGainCorrection);
  if (finding.name == kGyroscopeGain && finding.evidence.contains(kIsCorrected))
    stream.rate_scale *= finding.evidence.at(kRateCorrection);
  if (finding.name == kImuLate) stream.time_shift -= finding.evidence.at(kDelay);
  if (finding.name == kWheelsLate) stream.time_shift -= finding.evidence.at(kDelay);
  if (finding.name == kImuStuck) stream.stuck = checks.StuckImu();
}

/// \param has_only_poses  wheels say where they are, not how fast
CheckedTopics TopicsOf(const std::vector<SensorStream>& streams, bool has_only_poses) {
  CheckedTopics topics;
  for (const SensorStream& stream : streams) {
    if (stream.kind == StreamKind::kImage) {
      topics.cameras.resize(
          std::max(topics.cameras.size(), static_cast<std::size_t>(stream.camera) + 1));
      topics.cameras[static_cast<std::size_t>(stream.camera)] = stream.topic_name;
    }
    if (stream.kind == StreamKind::kImu) topics.imu = stream.topic_name;
    if (stream.kind == StreamKind::kWheels && !has_only_poses) topics.wheels = stream.topic_name;
    if (stream.kind == StreamKind::kGnss) topics.gnss = stream.topic_name;
  }
  return topics;
}

}  // namespace

std::string EncodeSurveys(std::vector<LogSurvey> surveys) {
  BinaryWriter writer;
  writer(surveys);
  return writer.bytes();
}

std::vector<LogSurvey> DecodeSurveys(std::string_view bytes) {
  std::vector<LogSurvey> surveys;
  BinaryReader reader(bytes);
  reader(surveys);
  Require(reader.is_at_end() && !surveys.empty(), ErrorCode::kInvalidInput,
          "these are no surveys of a log");
  return surveys;
}

bool ClocksMayLeap(const LogSurvey& survey) {
  constexpr double kMaxGap = 2;             // [s] of the IMU
  constexpr std::uint64_t kMaxStrange = 5;  // messages of a stream
  for (std::size_t i = 0; i < survey.streams.size(); ++i) {
    const StreamHealth& health = survey.health[i];
    if (survey.streams[i].kind == StreamKind::kImu && health.longest_gap > kMaxGap) return true;
    if (health.Dropped(DropReason::kBackwardStamp) + health.Dropped(DropReason::kOffClock) >
        kMaxStrange)
      return true;
  }
  return false;
}

LogSurvey SurveyLog(const MessageSource& source, std::vector<SensorStream> streams, const Rig& rig,
                    int stretch) {
  LogSurvey survey;
  survey.stretch = stretch;
  survey.streams = std::move(streams);
  ArrivalStream arrivals(source, survey.streams, std::vector<bool>(survey.streams.size(), true),
                         nullptr, stretch);
  std::vector<ImageSurvey> images(survey.streams.size());
  LogChecks checks(rig);
  std::optional<Timestamp> front;
  while (std::optional<Arrival> arrival = arrivals.Next()) {
    const auto index = static_cast<std::size_t>(arrival->stream);
    survey.span.Include(arrival->time);
    front = front ? std::max(*front, arrival->time) : arrival->time;
    const double lag = *front - arrival->time;
    if (lag <= kMaxReorderWindow) survey.reorder_window = std::max(survey.reorder_window, lag);
    if (auto* image = std::get_if<EncodedImage>(&arrival->content)) {
      const SensorStream& stream = survey.streams[index];
      const RigCamera& camera = rig.cameras[static_cast<std::size_t>(stream.camera)];
      images[index].Include(*image, stream, camera);
      if (stream.kind == StreamKind::kImage &&
          checks.cameras().WantsImage(stream.camera, arrival->time))
        checks.cameras().IncludeImage(stream.camera, arrival->time,
                                      Undecoded(std::move(*image), stream, camera));
    } else if (const auto* imu = std::get_if<ImuSample>(&arrival->content)) {
      checks.Include(*imu);
    } else if (const auto* wheels = std::get_if<WheelSample>(&arrival->content)) {
      checks.Include(*wheels);
    } else if (const auto* fix = std::get_if<GnssFix>(&arrival->content)) {
      checks.Include(*fix);
    }
  }
  checks.cameras().FollowPairs();
  for (std::size_t i = 0; i < survey.streams.size(); ++i) {
    SensorStream& stream = survey.streams[i];
    stream.sample_bits = images[i].sample_bits();
    if (stream.kind != StreamKind::kWheels || !arrivals.HasWheelsWithOnlyPoses()) continue;
    stream.is_speed_from_pose = true;
    survey.findings.push_back(
        {"wheel_speed_from_pose",
         Severity::kNote,
         stream.topic_name,
         "the twist of " + stream.topic_name + " is always zero: speed is taken from its pose",
         "",
         {}});
    // A speed from two poses belongs midway between them, later than the survey saw it come.
    survey.reorder_window = std::min(kMaxReorderWindow, survey.reorder_window + 0.25);
  }
  survey.health = arrivals.health();
  survey.damage = arrivals.damage();
  std::vector<std::string> undecodable;
  undecodable.reserve(images.size());
  for (const ImageSurvey& image : images) undecodable.push_back(image.fault());
  Add(FindLosses(survey.streams, survey.health, undecodable), survey);
  const std::vector<Finding> found =
      checks.Findings(TopicsOf(survey.streams, arrivals.HasWheelsWithOnlyPoses()));
  Add(found, survey);
  for (const Finding& finding : found) {
    for (SensorStream& stream : survey.streams) Correct(finding, checks, stream);
    // Streams whose stamps are corrected lie further from the others than the survey saw.
    if (finding.evidence.contains(kDelay))
      survey.reorder_window = std::min(
          kMaxReorderWindow, survey.reorder_window + std::abs(finding.evidence.at(kDelay)));
    if (finding.name == kWheelsAreZero || finding.name == kWheelsAreCoarse ||
        finding.name == kWheelsAreBlind || finding.name == kWheelsStick ||
        finding.name == kGnssIsFrozen)
      LeaveOut([&](const SensorStream& stream) { return stream.topic_name == finding.topic; },
               survey);
    if (finding.name == kCameraContradicts)
      LeaveOut([camera = CameraOf(finding.topic, survey.streams)](
                   const SensorStream& stream) { return stream.camera == camera; },
               survey);
  }
  Add(FindUncovered(survey.streams, survey.health), survey);
  return survey;
}

}  // namespace parkade
