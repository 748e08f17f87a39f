#pragma once

#include <vector>

#include "server/pipeline/build_context.h"
#include "server/pipeline/drive_in_work.h"

namespace parkade {

/// Joins the drives to one site by keyframes that two of them passed and by GNSS (JoinDrives), and
/// puts their final trajectories into `built`. Drives that do not fit go to its left-out ones and
/// off the list. Findings about pairs of drives are taken from the map that the build starts from,
/// and kept.
void JoinSite(const BuildContext& context, std::vector<DriveInWork>& drives, BuiltMap& built);

/// Places the joined site on Earth: GNSS says how sure that is; pins, where there are any, have the
/// last word.
void PutOnEarth(const BuildContext& context, BuiltMap& built);

/// One sentence for each drive that was left out and for what the logs lost, as far as they were
/// read.
void WarnOfLosses(const std::vector<DriveInWork>& drives, BuiltMap& built);

}  // namespace parkade
