#pragma once

#include <vector>

#include "server/ingest/checks/finding.h"
#include "server/ingest/drive/drive_log_health.h"
#include "server/ingest/messages/sensor_stream.h"

namespace parkade {

/// Parts of a drive that streams do not cover: an IMU that ends before the images do, or is silent
/// in between; a camera or wheels that are missing for a tenth of it; cameras with
/// hardly any images.
///
/// \param streams, health  alike in number and order
std::vector<Finding> FindUncovered(const std::vector<SensorStream>& streams,
                                   const std::vector<StreamHealth>& health);

}  // namespace parkade
