#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/drive_log.h"

namespace parkade::simulator {

enum class RosEncoding { kRos1, kCdr };

/// A message type as both kinds of log want it described.
struct RosType {
  std::string ros1_name, ros2_name;
  std::string ros1_definition, ros2_definition;  ///< the .msg text with those of its parts
  std::string ros1_md5;
};

const RosType& CompressedImageType();
const RosType& ImuType();
const RosType& NavSatFixType();
const RosType& OdometryType();

struct RosHeader {
  std::uint32_t sequence = 0;  ///< ROS 1 only
  Timestamp stamp;
  std::string frame;
};

// The bytes of a message: ROS 1 serialization, or little-endian plain CDR with its four bytes of
// encapsulation.
std::vector<std::uint8_t> EncodeCompressedImage(const RosHeader& header, const std::string& format,
                                                std::span<const std::uint8_t> file,
                                                RosEncoding encoding);
std::vector<std::uint8_t> EncodeImu(const RosHeader& header, const ImuSample& sample,
                                    RosEncoding encoding);
std::vector<std::uint8_t> EncodeNavSatFix(const RosHeader& header, const GnssFix& fix,
                                          RosEncoding encoding);
/// Twist in `child_frame`, and the pose dead-reckoned from it.
std::vector<std::uint8_t> EncodeOdometry(const RosHeader& header, const std::string& child_frame,
                                         const WheelSample& sample, const Rigid3& odom_from_body,
                                         RosEncoding encoding);

}  // namespace parkade::simulator
