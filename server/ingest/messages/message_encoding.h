#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/drive_log.h"
#include "server/ingest/messages/message_decoding.h"

namespace parkade {

// ROS 2 messages (CDR, little endian) of what Parkade reads: decoded again, they say the same.

/// A sensor_msgs/Imu without an orientation.
std::vector<std::uint8_t> EncodeImu(const ImuSample& sample, const std::string& frame_id);
/// A geometry_msgs/TwistStamped.
std::vector<std::uint8_t> EncodeTwist(const WheelSample& sample, const std::string& frame_id);
/// A sensor_msgs/NavSatFix of GPS.
std::vector<std::uint8_t> EncodeNavSat(const NavSatMessage& message);
/// A sensor_msgs/Image.
std::vector<std::uint8_t> EncodeImage(const ImageMessage& message);
/// A sensor_msgs/CompressedImage.
std::vector<std::uint8_t> EncodeCompressedImage(const CompressedImageMessage& message);

}  // namespace parkade
