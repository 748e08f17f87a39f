#include "server/ingest/inspection/topic_inspection.h"

#include <algorithm>

#include "core/error.h"
#include "core/math/statistics.h"
#include "server/ingest/messages/sensor_decoding.h"

namespace parkade {
namespace {

constexpr std::size_t kMaxSteps = 10'000, kMaxGaps = 10;

/// The types that begin with a std_msgs/Header.
bool HasStamp(const std::string& type) {
  return IsImageType(type) || IsWheelType(type) || type == "sensor_msgs/Imu" ||
         type == "sensor_msgs/NavSatFix" || type == "sensor_msgs/CameraInfo";
}

}  // namespace

TopicInspector::TopicInspector(const TopicInfo& topic) : topic_(topic) {
  found_.topic = topic.topic;
  found_.type = topic.type;
}

void TopicInspector::IncludeMessage(const RawMessage& message) {
  ++found_.num_messages;
  found_.num_bytes += message.data.size();
  try {
    Timestamp stamp = message.log_time;
    if (HasStamp(topic_.type) && topic_.encoding != MessageEncoding::kEuroc) {
      stamp = StampOf(message, topic_.encoding, topic_.type);
      if (DecodeHeader(message.data, topic_.encoding, topic_.type).stamp.ns == 0)
        ++found_.num_without_stamp;
    }
    IncludeStamp(stamp);
    CheckContent(message);
  } catch (const Error& error) {
    IncludeFault(message.log_time, error.what());
  }
}

void TopicInspector::IncludeStamp(Timestamp stamp) {
  const auto seconds_from = [&](Timestamp earlier) {  // cannot overflow, whatever the stamps
    return static_cast<double>(stamp.ns) * 1e-9 - static_cast<double>(earlier.ns) * 1e-9;
  };
  const bool is_first = found_.span.IsEmpty();
  if (!is_first && stamp == last_stamp_) ++found_.num_repeated;
  if (!is_first && stamp < last_stamp_) {
    ++found_.num_backward;
    found_.largest_backward_jump =
        std::max(found_.largest_backward_jump, -seconds_from(last_stamp_));
  }
  if (!is_first && stamp > found_.span.end) {
    const double step = seconds_from(found_.span.end);
    if (first_steps_.size() < kMaxSteps) first_steps_.push_back(step);
    const auto at = std::find_if(long_steps_.begin(), long_steps_.end(),
                                 [&](const auto& gap) { return gap.seconds < step; });
    long_steps_.insert(at, {found_.span.end, step});
    if (long_steps_.size() > kMaxGaps) long_steps_.pop_back();
  }
  found_.span.Include(stamp);
  last_stamp_ = stamp;
}

void TopicInspector::CheckContent(const RawMessage& message) {
  SensorStream stream;
  stream.type = topic_.type;
  stream.encoding = topic_.encoding;
  bool is_plausible = true;
  if (topic_.type == "sensor_msgs/Imu") {
    is_plausible = IsPlausible(ReadImuSample(message, stream));
  } else if (topic_.type == "sensor_msgs/NavSatFix") {
    const std::optional<GnssFix> fix = ReadGnssFix(message, stream);
    is_plausible = !fix || IsPlausible(*fix);
  } else if (IsWheelType(topic_.type)) {
    const OdometryMessage odometry = ReadOdometry(message, stream);
    is_plausible = IsPlausible(WheelSample{last_stamp_, odometry.linear.x(), odometry.angular.z()});
  } else if (topic_.type == "sensor_msgs/CameraInfo") {
    DecodeCameraInfo(message.data, topic_.encoding);
  } else if (topic_.type == "tf2_msgs/TFMessage") {
    DecodeTransforms(message.data, topic_.encoding);
  } else if (found_.image_encoding.empty() && topic_.encoding != MessageEncoding::kEuroc) {
    if (topic_.type == "sensor_msgs/Image")
      found_.image_encoding = DecodeImage(message.data, topic_.encoding).encoding;
    if (IsCompressedImageType(topic_.type))
      found_.image_encoding =
          DecodeCompressedImage(message.data, topic_.encoding, topic_.type).format;
  }
  if (is_plausible) return;
  ++found_.num_implausible;
  if (found_.first_fault.empty())
    found_.first_fault = "impossible values at " + ToDecimalSeconds(last_stamp_);
}

void TopicInspector::IncludeImage(Timestamp time, int width, int height) {
  if (found_.width == 0) {
    found_.width = width;
    found_.height = height;
  }
  if (width == found_.width && height == found_.height) return;
  ++found_.num_other_sizes;
  if (found_.first_fault.empty())
    found_.first_fault = "size " + std::to_string(width) + "x" + std::to_string(height) + " at " +
                         ToDecimalSeconds(time);
}

void TopicInspector::IncludeFault(Timestamp time, const std::string& what) {
  ++found_.num_undecodable;
  if (found_.first_fault.empty()) found_.first_fault = what + " at " + ToDecimalSeconds(time);
}

TopicInspection TopicInspector::Finish() const {
  TopicInspection inspection = found_;
  std::vector<double> steps = first_steps_;
  if (!steps.empty()) {
    inspection.median_step = Median(std::move(steps));
  }
  // Messages of other types may come whenever something happens.
  const bool is_regular = HasStamp(topic_.type);
  for (const TopicInspection::Gap& step : long_steps_)
    if (is_regular && step.seconds > std::max(0.1, 3 * inspection.median_step))
      inspection.gaps.push_back(step);
  return inspection;
}

}  // namespace parkade
