#pragma once

#include <string>
#include <vector>

#include "server/ingest/checks/finding.h"
#include "slam/odometry/odometry_result.h"
#include "slam/refinement/sensor_agreement.h"

namespace parkade {

/// What is wrong with a drive's sensors, as its trajectory tells.
/// \param gnss_doubt  "jump by 30 m": what fixes do that are left out for it; empty: nothing
std::vector<Finding> TrajectoryFindings(const OdometryReport& odometry,
                                        const SensorAgreement& agreement,
                                        const std::string& gnss_doubt);

}  // namespace parkade
