#pragma once

#include <vector>

#include "tests/bench/odometry/odometry_statistics.h"

namespace parkade {

/// What the odometry is asked with: rigs that are off, wheels, subsets of
/// cameras, starts, faults. `duration` [s] of each drive, in `scene`.
std::vector<StatisticsCase> StandardCases(const std::string& scene, double duration);

}  // namespace parkade
