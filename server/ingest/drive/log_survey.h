#pragma once

#include <string>
#include <vector>

#include "core/rig.h"
#include "core/timestamp.h"
#include "server/ingest/drive/drive_log_health.h"
#include "server/ingest/messages/sensor_stream.h"

namespace parkade {

/// Facts about a whole drive that must be known before its first record can be passed on.
struct LogSurvey {
  TimeSpan span;  ///< of all records on the drive's clock
  double reorder_window =
      0;  ///< [s] furthest that a record lies behind the newest before it, at most 2 s
  std::vector<SensorStream>
      streams;  ///< as given, with is_speed_from_pose and sample_bits filled in
  std::vector<StreamHealth> health;
  DamageReport damage;
  std::vector<std::string> warnings;
};

/// Reads the log once without decoding images, but for the first of each camera. Throws
/// Error{kInvalidInput} when no IMU sample or no image is on the drive's clock, or when a camera's
/// images are not of the calibrated size.
LogSurvey SurveyLog(const MessageSource& source, std::vector<SensorStream> streams, const Rig& rig);

}  // namespace parkade
