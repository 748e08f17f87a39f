#include "server/ingest/messages/message_encoding.h"

#include "server/ingest/writing/cdr_writer.h"

namespace parkade {
namespace {

CdrWriter Begin(const MessageHeader& header) {
  CdrWriter writer;
  writer.Header(header.stamp, header.frame_id);
  return writer;
}

std::span<const double> NumbersOf(const Eigen::Vector3d& vector) { return {vector.data(), 3}; }

}  // namespace

std::vector<std::uint8_t> EncodeImu(const ImuSample& sample, const std::string& frame_id) {
  const std::array<double, 9> unknown{};
  std::array<double, 9> none{};
  none[0] = -1;  // the sign that there is no such value
  CdrWriter writer = Begin({sample.time, frame_id});
  writer.Doubles(std::array{0.0, 0.0, 0.0, 1.0}).Doubles(none);
  writer.Doubles(NumbersOf(sample.angular_velocity)).Doubles(unknown);
  return writer.Doubles(NumbersOf(sample.linear_acceleration)).Doubles(unknown).Take();
}

std::vector<std::uint8_t> EncodeTwist(const WheelSample& sample, const std::string& frame_id) {
  CdrWriter writer = Begin({sample.time, frame_id});
  const std::array twist{sample.forward_speed, 0.0, 0.0, 0.0, 0.0, sample.yaw_rate};
  return writer.Doubles(twist).Take();
}

std::vector<std::uint8_t> EncodeNavSat(const NavSatMessage& message) {
  CdrWriter writer = Begin(message.header);
  constexpr std::uint16_t kGps = 1;
  writer.Put(message.status).Put(kGps);
  writer.Put(message.latitude_deg).Put(message.longitude_deg).Put(message.altitude);
  writer.Doubles(message.covariance);
  return writer.Put(static_cast<std::uint8_t>(message.covariance_type)).Take();
}

std::vector<std::uint8_t> EncodeImage(const ImageMessage& message) {
  CdrWriter writer = Begin(message.header);
  writer.Put(message.height).Put(message.width).Text(message.encoding);
  writer.Put(static_cast<std::uint8_t>(message.is_bigendian)).Put(message.step);
  return writer.Bytes(message.data).Take();
}

std::vector<std::uint8_t> EncodeCompressedImage(const CompressedImageMessage& message) {
  return Begin(message.header).Text(message.format).Bytes(message.data).Take();
}

}  // namespace parkade
