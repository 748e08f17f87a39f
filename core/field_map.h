#pragma once

#include <map>
#include <string>

namespace parkade {

/// A number in the messages of a topic, as `scale` * number + `offset`.
struct FieldSignal {
  std::string topic;
  std::string path;  ///< "twist.linear.x", see server/ingest/schemas/message_path.h
  double scale = 1, offset = 0;
};

/// Signals of one sensor by their names (docs/drive_logs.md, "Field map").
using FieldSignals = std::map<std::string, FieldSignal>;

/// Where sensors stand in messages of types that Parkade does not know. Empty signals: the sensor
/// is a topic of a known type.
struct FieldMap {
  FieldSignals imu;     ///< [rad/s], [m/s^2]
  FieldSignals wheels;  ///< [m/s], [rad/s], [rad], ticks
  FieldSignals gnss;    ///< [deg], [m]
  double meters_per_tick = 0;

  bool IsEmpty() const { return imu.empty() && wheels.empty() && gnss.empty(); }
};

}  // namespace parkade
