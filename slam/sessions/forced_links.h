#pragma once

#include <vector>

#include "slam/sessions/drive_to_join.h"
#include "slam/sessions/reviewed_links.h"

namespace parkade {

/// Measures the links that a reviewer forces and that were not found, and adds them to their pairs
/// as links that are not doubted. Those that cannot be measured are left out.
///
/// \param pairs  as ReviewedLinks::Judge left them; pairs that were not compared are added
void AddForcedLinks(const ReviewedLinks& reviewed, const std::vector<DriveToJoin>& drives,
                    const LoopOptions& loops, const SessionLoopOptions& options,
                    std::vector<DrivePair>& pairs);

}  // namespace parkade
