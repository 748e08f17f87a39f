#pragma once

#include <cstddef>
#include <vector>

#include "server/pipeline/progress.h"

namespace parkade {

/// The stages that BuildMap goes through, for Progress.
std::vector<StagePlan> PlanStages(size_t num_drives, bool is_odometry_only);

/// The stages that PrepareDrive goes through.
std::vector<StagePlan> PlanPreparation();

}  // namespace parkade
