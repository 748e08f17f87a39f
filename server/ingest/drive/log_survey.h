#pragma once

#include <string>
#include <string_view>
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
  /// As given, with is_speed_from_pose, sample_bits and a corrected acceleration_scale filled in.
  std::vector<SensorStream> streams;
  std::vector<StreamHealth> health;
  DamageReport damage;
  std::vector<Finding> findings;
  int stretch = 0;                 ///< of the log, by the streams' clocks
  std::uint64_t num_left_out = 0;  ///< messages of streams that are left out whole
};

/// Reads the log once without decoding images, but for the first of each camera, and
/// cross-examines it. Streams that cannot be believed are left out, with a finding. Throws
/// Error{kInvalidInput} when a camera's images are not of the calibrated size.
LogSurvey SurveyLog(const MessageSource& source, std::vector<SensorStream> streams, const Rig& rig,
                    int stretch = 0);

/// Raised whenever the layout of EncodeSurveys changes, or what is found in the same log.
inline constexpr int kSurveyVersion = 2;

/// The surveys of a log's stretches as bytes, every number as it is in memory.
std::string EncodeSurveys(std::vector<LogSurvey> surveys);
/// What was encoded. Throws Error{kInvalidInput} for other bytes.
std::vector<LogSurvey> DecodeSurveys(std::string_view bytes);

/// Whether the stamps of some stream leap, so that its clock has to be looked at.
bool ClocksMayLeap(const LogSurvey& survey);

}  // namespace parkade
