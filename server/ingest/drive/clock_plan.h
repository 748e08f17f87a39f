#pragma once

#include <vector>

#include "server/ingest/checks/finding.h"
#include "server/ingest/drive/stamp_runs.h"
#include "server/ingest/messages/sensor_stream.h"

namespace parkade {

/// How the clocks of a log went: in stretches that no clock leaps in.
struct ClockPlan {
  std::vector<std::vector<ClockRun>> runs;  ///< per stream
  int num_stretches = 1;
  std::vector<Finding> findings;
};

/// Finds where clocks leap. Where those of most streams leap together, a new stretch begins: nobody
/// knows what the car did meanwhile. Where one stream's steps alone, its stamps are put back so
/// that they go on as before. A leap forward that the recorder's clock shares is a gap in a stream
/// alone. The first stream is the IMU's.
ClockPlan PlanClocks(const std::vector<SensorStream>& streams,
                     const std::vector<StampSequence>& sequences);

}  // namespace parkade
