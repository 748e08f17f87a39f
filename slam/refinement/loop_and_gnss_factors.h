#pragma once

#include <vector>

#include "slam/loops/loop_closure.h"
#include "slam/refinement/adjusted_drive.h"
#include "slam/refinement/drive_refinement.h"

namespace parkade {

/// The accepted loops of a drive between its nodes: those whose ends lie within them. `odometry` is
/// odom_from_body, in which the loops were measured.
std::vector<AdjustedLoop> LoopsBetweenNodes(const DriveMeasurements& measurements,
                                            const Trajectory& odometry, const LoopClosure& closure);

/// Fixes of a drive between its nodes, and where odom lies among them.
struct PlacedFixes {
  std::vector<AdjustedFix> fixes;
  Rigid3 site_from_odom;
};

/// Empty where the fixes do not tell which way the drive heads (AlignToGnss).
PlacedFixes FixesBetweenNodes(const DriveMeasurements& measurements, const Rig& rig,
                              const Trajectory& odom_from_body, const GnssPositions& gnss);

}  // namespace parkade
