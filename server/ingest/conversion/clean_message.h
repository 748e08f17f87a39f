#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/rig.h"
#include "server/ingest/drive/timestamp_filter.h"
#include "server/ingest/messages/sensor_stream.h"

namespace parkade {

/// A message of a clean log.
struct CleanMessage {
  std::string type;  ///< ROS 1 spelling
  std::vector<std::uint8_t> data;
};

/// The message for a record of a drive: IMU samples as sensor_msgs/Imu, wheels as
/// geometry_msgs/TwistStamped, fixes as sensor_msgs/NavSatFix; images as their file or their pixels
/// lie in the log, those of a video as mono8 or bgr8. Nothing for an image that cannot be decoded.
/// Throws Error{kInvalidInput} or {kNotFound} where an image's file cannot be read.
std::optional<CleanMessage> MakeCleanMessage(const Arrival& arrival, const SensorStream& stream,
                                             const Rig& rig);

}  // namespace parkade
