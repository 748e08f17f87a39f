#include "server/ingest/messages/message_decoding.h"

#include <cassert>

#include "server/ingest/messages/message_reader.h"

namespace parkade {
namespace {

template <typename Walk>
auto WithReader(std::span<const std::uint8_t> data, MessageEncoding encoding, const Walk& walk) {
  assert(encoding != MessageEncoding::kEuroc);
  if (encoding == MessageEncoding::kRos1) {
    Ros1Reader reader(data);
    return walk(reader);
  }
  CdrReader reader(data);
  return walk(reader);
}

constexpr const char* kFoxgloveVideo = "foxglove_msgs/CompressedVideo";
constexpr const char* kFfmpegPacket = "ffmpeg_image_transport_msgs/FFMPEGPacket";

/// [ns] of a stamp. Nanoseconds make less than a second; as many as a date has seconds say that a
/// driver wrote the two in each other's place.
std::int64_t StampFrom(std::uint32_t seconds, std::uint32_t nanoseconds) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  constexpr std::uint32_t kDate = 1'500'000'000;  // [s] in July 2017
  if (nanoseconds >= kDate && seconds < kSecond) std::swap(seconds, nanoseconds);
  return seconds * kSecond + nanoseconds;
}

template <typename Reader>
MessageHeader ReadStampAndFrame(Reader& reader) {
  MessageHeader header;
  const auto seconds = reader.template Read<std::uint32_t>();
  const auto nanoseconds = reader.template Read<std::uint32_t>();
  header.stamp.ns = StampFrom(seconds, nanoseconds);
  header.frame_id = reader.ReadString();
  return header;
}

template <typename Reader>
MessageHeader ReadHeader(Reader& reader) {
  if constexpr (Reader::kHeaderHasSequence) reader.template Read<std::uint32_t>();
  return ReadStampAndFrame(reader);
}

template <typename Reader>
Eigen::Vector3d ReadVector3(Reader& reader) {
  Eigen::Vector3d vector;
  for (int i = 0; i < 3; ++i) vector[i] = reader.template Read<double>();
  return vector;
}

template <std::size_t kCount, typename Reader>
std::array<double, kCount> ReadDoubles(Reader& reader) {
  std::array<double, kCount> values;
  for (double& value : values) value = reader.template Read<double>();
  return values;
}

/// Reads a translation, then a quaternion x y z w (left as it is: the caller decides about one that
/// is not of length 1).
template <typename Reader>
Rigid3 ReadRigid3(Reader& reader) {
  Rigid3 motion;
  motion.translation = ReadVector3(reader);
  for (int i = 0; i < 4; ++i) motion.rotation.coeffs()[i] = reader.template Read<double>();
  return motion;
}

}  // namespace

bool IsImageType(const std::string& type) {
  return type == "sensor_msgs/Image" || IsCompressedImageType(type);
}

bool IsCompressedImageType(const std::string& type) {
  return type == "sensor_msgs/CompressedImage" || type == kFoxgloveVideo || type == kFfmpegPacket;
}

bool IsWheelType(const std::string& type) {
  return type == "nav_msgs/Odometry" || type == "geometry_msgs/TwistStamped" ||
         type == "geometry_msgs/TwistWithCovarianceStamped";
}

MessageHeader DecodeHeader(std::span<const std::uint8_t> data, MessageEncoding encoding,
                           const std::string& type) {
  return WithReader(data, encoding, [&](auto& reader) {
    return type == kFoxgloveVideo ? ReadStampAndFrame(reader) : ReadHeader(reader);
  });
}

ImuMessage DecodeImu(std::span<const std::uint8_t> data, MessageEncoding encoding) {
  return WithReader(data, encoding, [](auto& reader) {
    ImuMessage message;
    message.header = ReadHeader(reader);
    ReadDoubles<4>(reader);  // orientation
    ReadDoubles<9>(reader);
    message.angular_velocity = ReadVector3(reader);
    ReadDoubles<9>(reader);
    message.linear_acceleration = ReadVector3(reader);
    return message;
  });
}

OdometryMessage DecodeOdometry(std::span<const std::uint8_t> data, MessageEncoding encoding,
                               const std::string& type) {
  assert(IsWheelType(type));
  return WithReader(data, encoding, [&](auto& reader) {
    OdometryMessage message;
    message.header = ReadHeader(reader);
    if (type == "nav_msgs/Odometry") {
      reader.ReadString();  // child_frame_id
      message.odom_from_child = ReadRigid3(reader);
      message.has_pose = true;
      ReadDoubles<36>(reader);
    }
    message.linear = ReadVector3(reader);
    message.angular = ReadVector3(reader);
    return message;
  });
}

NavSatMessage DecodeNavSat(std::span<const std::uint8_t> data, MessageEncoding encoding) {
  return WithReader(data, encoding, [](auto& reader) {
    NavSatMessage message;
    message.header = ReadHeader(reader);
    message.status = reader.template Read<std::int8_t>();
    reader.template Read<std::uint16_t>();  // service
    message.latitude_deg = reader.template Read<double>();
    message.longitude_deg = reader.template Read<double>();
    message.altitude = reader.template Read<double>();
    message.covariance = ReadDoubles<9>(reader);
    message.covariance_type = reader.template Read<std::uint8_t>();
    return message;
  });
}

CameraInfoMessage DecodeCameraInfo(std::span<const std::uint8_t> data, MessageEncoding encoding) {
  return WithReader(data, encoding, [](auto& reader) {
    CameraInfoMessage message;
    message.header = ReadHeader(reader);
    message.height = reader.template Read<std::uint32_t>();
    message.width = reader.template Read<std::uint32_t>();
    message.distortion_model = reader.ReadString();
    const std::size_t count = reader.ReadCount(sizeof(double));
    for (std::size_t i = 0; i < count; ++i)
      message.distortion.push_back(reader.template Read<double>());
    message.intrinsic_matrix = ReadDoubles<9>(reader);
    ReadDoubles<9>(reader);  // rectification
    message.projection_matrix = ReadDoubles<12>(reader);
    return message;
  });
}

std::vector<TransformMessage> DecodeTransforms(std::span<const std::uint8_t> data,
                                               MessageEncoding encoding) {
  return WithReader(data, encoding, [](auto& reader) {
    // Stamp, two empty strings and seven numbers are the least that a transform takes.
    constexpr std::size_t kMinTransformSize = 16 + 7 * sizeof(double);
    std::vector<TransformMessage> messages(reader.ReadCount(kMinTransformSize));
    for (TransformMessage& message : messages) {
      message.header = ReadHeader(reader);
      message.child_frame_id = reader.ReadString();
      message.parent_from_child = ReadRigid3(reader);
    }
    return messages;
  });
}

ImageMessage DecodeImage(std::span<const std::uint8_t> data, MessageEncoding encoding) {
  return WithReader(data, encoding, [](auto& reader) {
    ImageMessage message;
    message.header = ReadHeader(reader);
    message.height = reader.template Read<std::uint32_t>();
    message.width = reader.template Read<std::uint32_t>();
    message.encoding = reader.ReadString();
    message.is_bigendian = reader.template Read<std::uint8_t>() != 0;
    message.step = reader.template Read<std::uint32_t>();
    message.data = reader.ReadBytes();
    return message;
  });
}

CompressedImageMessage DecodeCompressedImage(std::span<const std::uint8_t> data,
                                             MessageEncoding encoding, const std::string& type) {
  assert(IsCompressedImageType(type));
  return WithReader(data, encoding, [&](auto& reader) {
    CompressedImageMessage message;
    if (type == kFoxgloveVideo) {
      message.header = ReadStampAndFrame(reader);
      message.data = reader.ReadBytes();
      message.format = reader.ReadString();
      return message;
    }
    message.header = ReadHeader(reader);
    if (type == kFfmpegPacket) {
      reader.template Read<std::int32_t>();  // width
      reader.template Read<std::int32_t>();  // height
    }
    message.format = reader.ReadString();
    if (type == kFfmpegPacket) {
      reader.template Read<std::uint64_t>();  // presentation time
      reader.template Read<std::uint8_t>();   // flags
      reader.template Read<std::uint8_t>();   // is_bigendian
    }
    message.data = reader.ReadBytes();
    return message;
  });
}

}  // namespace parkade
