#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/timestamp.h"
#include "server/ingest/containers/raw_message.h"

namespace parkade {

enum class StreamKind { kImu, kWheels, kGnss, kImage, kSemantic };

/// Messages of a stream in a row whose clock was not set meanwhile.
struct ClockRun {
  std::uint64_t begin = 0;  ///< first message of the stream, in the order of the log
  double correction = 0;    ///< [s] added to its stamps
  int stretch = 0;          ///< of the log that it is part of; -1: one too short for a drive
};

/// One topic of a log with its role in the drive.
struct SensorStream {
  StreamKind kind = StreamKind::kImu;
  int topic = 0;    ///< index into MessageSource::topics()
  int camera = -1;  ///< index into Rig::cameras of images and masks
  std::string role;
  std::string topic_name;
  std::string type;  ///< ROS 1 spelling
  MessageEncoding encoding = MessageEncoding::kRos1;
  double time_shift = 0;        ///< [s] added to each stamp; not of GNSS
  std::vector<TimeSpan> stuck;  ///< an IMU whose driver repeats a reading then: not used
  std::vector<ClockRun> clock;  ///< in the order of the log; empty: one run, as it is
  // Units: what one of the log's is worth.
  double acceleration_scale = 1;  ///< [m/s^2]
  double rate_scale = 1;          ///< [rad/s]
  double speed_scale = 1;         ///< [m/s]
  /// Wheels whose twist is zero over the whole drive while the pose moves: speed from differences
  /// of the pose.
  bool is_speed_from_pose = false;
  /// Images with 16 bits per sample: how many of them the camera uses. 8-bit values are `sample >>
  /// (bits - 8)`.
  int sample_bits = 16;
};

}  // namespace parkade
