#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/rigid3.h"
#include "core/timestamp.h"
#include "server/ingest/containers/raw_message.h"

namespace parkade {

// The ROS messages that Parkade reads, as far as it needs them. Field meanings: ROS common_msgs.
// Numbers are as recorded: nothing here is known to be finite. Thread-safe: pure functions. All
// throw Error{kInvalidInput} when the bytes do not hold the message.

struct MessageHeader {
  Timestamp stamp;  ///< 0 where the sender left it empty
  std::string frame_id;
};

struct ImuMessage {
  MessageHeader header;
  Eigen::Vector3d angular_velocity;     ///< [rad/s]
  Eigen::Vector3d linear_acceleration;  ///< [m/s^2]
};

/// A nav_msgs/Odometry, or one of the two stamped twists (then without a pose).
struct OdometryMessage {
  MessageHeader header;
  bool has_pose = false;
  Rigid3 odom_from_child;
  Eigen::Vector3d linear;   ///< [m/s] in the child frame
  Eigen::Vector3d angular;  ///< [rad/s]
};

struct NavSatMessage {
  MessageHeader header;
  std::int8_t status = 0;  ///< -1 no fix, 0 fix, 1 SBAS, 2 GBAS
  double latitude_deg = 0, longitude_deg = 0, altitude = 0;
  std::array<double, 9> covariance{};  ///< [m^2] east, north, up, row by row
  int covariance_type = 0;             ///< 0 unknown
};

struct CameraInfoMessage {
  MessageHeader header;
  std::uint32_t width = 0, height = 0;
  std::string distortion_model;
  std::vector<double> distortion;
  std::array<double, 9> intrinsic_matrix{};    ///< K, row by row
  std::array<double, 12> projection_matrix{};  ///< P of the rectified image, row by row
};

struct TransformMessage {
  MessageHeader header;  ///< frame_id is the parent
  std::string child_frame_id;
  Rigid3 parent_from_child;
};

/// A sensor_msgs/Image. `data` points into the message.
struct ImageMessage {
  MessageHeader header;
  std::uint32_t width = 0, height = 0, step = 0;
  std::string encoding;
  bool is_bigendian = false;
  std::span<const std::uint8_t> data;
};

/// A message of one of the types of IsCompressedImageType. `data` points into the message.
struct CompressedImageMessage {
  MessageHeader header;
  std::string format;  ///< as the sender has it: "jpeg", "h264", "libx264"
  std::span<const std::uint8_t> data;
};

/// Decodes the stamp and the frame of any message that begins with a std_msgs/Header, or with these
/// two (foxglove_msgs).
MessageHeader DecodeHeader(std::span<const std::uint8_t> data, MessageEncoding encoding,
                           const std::string& type);

ImuMessage DecodeImu(std::span<const std::uint8_t> data, MessageEncoding encoding);

/// `type` is one of the three wheel types (IsWheelType).
OdometryMessage DecodeOdometry(std::span<const std::uint8_t> data, MessageEncoding encoding,
                               const std::string& type);

NavSatMessage DecodeNavSat(std::span<const std::uint8_t> data, MessageEncoding encoding);
CameraInfoMessage DecodeCameraInfo(std::span<const std::uint8_t> data, MessageEncoding encoding);
std::vector<TransformMessage> DecodeTransforms(std::span<const std::uint8_t> data,
                                               MessageEncoding encoding);
ImageMessage DecodeImage(std::span<const std::uint8_t> data, MessageEncoding encoding);
/// `type` is one of IsCompressedImageType.
CompressedImageMessage DecodeCompressedImage(std::span<const std::uint8_t> data,
                                             MessageEncoding encoding, const std::string& type);

bool IsImageType(const std::string& type);
/// sensor_msgs/CompressedImage, foxglove_msgs/CompressedVideo and
/// ffmpeg_image_transport_msgs/FFMPEGPacket.
bool IsCompressedImageType(const std::string& type);
bool IsWheelType(const std::string& type);

}  // namespace parkade
