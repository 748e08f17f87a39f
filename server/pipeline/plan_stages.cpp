#include "server/pipeline/plan_stages.h"

namespace parkade {

std::vector<StagePlan> PlanPreparation() {
  return {{"track", 70}, {"close loops", 15}, {"refine", 10}, {"observe ground", 15}};
}

std::vector<StagePlan> PlanStages(size_t num_drives, bool is_odometry_only) {
  // Weights are shares of the time that a typical drive takes.
  const double drives = static_cast<double>(num_drives);
  std::vector<StagePlan> plan = {{"track", 70 * drives},
                                 {"close loops", 15 * drives},
                                 {"refine", 10 * drives},
                                 {"join drives", num_drives > 1 ? 15 * drives : 2}};
  if (!is_odometry_only)
    plan.insert(plan.end(), {{"observe ground", 15 * drives},
                             {"fuse surface", 5 * drives},
                             {"mesh", 4 * drives},
                             {"texture", 15 * drives},
                             {"slots by drive", num_drives > 1 ? 20 * (drives - 1) : 0},
                             {"find markings", 2 * drives}});
  plan.push_back({"write", 4});
  return plan;
}

}  // namespace parkade
