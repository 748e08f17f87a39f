#pragma once

#include <string>

#include "core/rig.h"
#include "server/ingest/messages/sensor_stream.h"

namespace parkade {

// A clean log holds a drive as Parkade understood it: one clock, SI units, nothing that is damaged,
// repeated or out of order; types that ROS 2 has.

/// The topic of a stream in a clean log; images are there under this name or, where they are
/// compressed, with "/compressed" behind it.
std::string CleanTopic(const SensorStream& stream);

/// The rig that a clean log of these streams goes with: no time shifts, scales or field map, which
/// are applied, and only the sensors that are there.
Rig CleanRig(Rig rig, const std::vector<SensorStream>& streams);

}  // namespace parkade
