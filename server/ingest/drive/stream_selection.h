#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/rig.h"
#include "server/ingest/checks/finding.h"
#include "server/ingest/containers/raw_message.h"
#include "server/ingest/messages/sensor_stream.h"

namespace parkade {

struct StreamSelection {
  std::vector<SensorStream> streams;  ///< IMU first, then wheels, GNSS, cameras, masks
  std::vector<Finding> findings;      ///< mere notes
};

/// Finds the rig's sensors among the topics of a log.
///
/// Topics match with or without a leading slash and a trailing "/compressed" or "/ffmpeg"; in EuRoC
/// folders camera `camN` is `camN`, and the others are imu0, odom0, gnss0. An IMU, a wheel or a
/// GNSS topic that the rig does not name is taken when the log has exactly one of that type; of
/// several wheel or GNSS topics none is taken, with a note. A camera without a topic may be called
/// as the log's topic. Wheels need a vehicle.yaml (or an EuRoC odom0), which says where the body
/// frame is. `<camera>/semantic` may be the camera's name, its topic or its topic's folder. Throws
/// Error{kInvalidInput} naming the topics when there is no IMU, several of which the rig names
/// none, none of the cameras, or a camera that the rig gives no topic.
StreamSelection SelectStreams(const MessageSource& source, const Rig& rig, bool use_wheels,
                              bool use_gnss);

/// A topic's name without a leading slash and a trailing "/compressed" or "/ffmpeg".
std::string_view PlainTopic(std::string_view topic);

/// "/a, /b and /c", or "none".
std::string ListTopics(const std::vector<std::string>& topics);

}  // namespace parkade
