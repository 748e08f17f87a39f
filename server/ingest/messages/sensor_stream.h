#pragma once

#include <string>

#include "server/ingest/containers/raw_message.h"

namespace parkade {

enum class StreamKind { kImu, kWheels, kGnss, kImage, kSemantic };

/// One topic of a log with its role in the drive.
struct SensorStream {
  StreamKind kind = StreamKind::kImu;
  int topic = 0;    ///< index into MessageSource::topics()
  int camera = -1;  ///< index into Rig::cameras of images and masks
  std::string role;
  std::string topic_name;
  std::string type;  ///< ROS 1 spelling
  MessageEncoding encoding = MessageEncoding::kRos1;
  double time_shift = 0;  ///< [s] added to each stamp
  /// Wheels whose twist is zero over the whole drive while the pose moves: speed from differences
  /// of the pose.
  bool is_speed_from_pose = false;
  /// Images with 16 bits per sample: how many of them the camera uses. 8-bit values are `sample >>
  /// (bits - 8)`.
  int sample_bits = 16;
};

}  // namespace parkade
