#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/ingest/checks/finding.h"
#include "server/ingest/drive/drive_log_health.h"
#include "server/ingest/messages/sensor_stream.h"

namespace parkade {

/// "the IMU /imu", "camera cam0 (/cam0/image)"
std::string NameOf(const SensorStream& stream);

/// What the streams' losses amount to: a stream of which nothing is left, or much is missing; and
/// whether a map can be made from the rest.
///
/// \param streams, health  alike in number and order
/// \param undecodable      per stream: why none of its images can be decoded; empty where one can
std::vector<Finding> FindLosses(const std::vector<SensorStream>& streams,
                                const std::vector<StreamHealth>& health,
                                const std::vector<std::string>& undecodable);

/// That a stream loses much; nothing where it does not.
std::optional<Finding> FindLoss(const SensorStream& stream, const StreamHealth& health);

}  // namespace parkade
