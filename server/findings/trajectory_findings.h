#pragma once

#include <string>
#include <vector>

#include "core/rig.h"
#include "server/ingest/checks/finding.h"
#include "slam/odometry/odometry_result.h"
#include "slam/refinement/sensor_agreement.h"

namespace parkade {

/// What a drive's fixes are worth.
struct GnssVerdict {
  std::string doubt = "";    ///< what they do that are left out for it: "jump by 30 m"; or empty
  size_t num_too_vague = 0;  ///< of which none is left out, but which tell no place on earth
  size_t num_used = 0, num_apart = 0;  ///< fixes that agree with the trajectory; that do not
};

/// What is wrong with a drive's sensors, as its trajectory tells.
/// \param rig  of the drive; its cameras are those of the report
std::vector<Finding> TrajectoryFindings(const OdometryReport& odometry, const Rig& rig,
                                        const SensorAgreement& agreement, const GnssVerdict& gnss);

}  // namespace parkade
