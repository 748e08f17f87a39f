#pragma once

#include <memory>

#include "core/rig.h"
#include "server/ingest/containers/raw_message.h"

namespace parkade {

// The topics that a field map adds to a log: of sensor_msgs/Imu, geometry_msgs/TwistStamped and
// sensor_msgs/NavSatFix, in CDR.
inline constexpr const char* kImuFields = "/fields/imu";
inline constexpr const char* kWheelFields = "/fields/wheels";
inline constexpr const char* kGnssFields = "/fields/gnss";

/// The log with the sensors that the rig's field map describes as topics behind its own, whose
/// names are put into the rig. The source itself where the rig has no field map.
///
/// A message has the stamp of the signal `stamp` [s]; else that of its header; else the log's time.
/// One that does not fit its schema becomes an empty one. Reads the first messages of the topics.
/// Throws Error{kInvalidInput} with a sentence that names what there is, where the log lacks a
/// topic, a topic its schema, a message a field, or vehicle.yaml a length.
std::shared_ptr<const MessageSource> MapFields(std::shared_ptr<const MessageSource> source,
                                               Rig& rig);

}  // namespace parkade
