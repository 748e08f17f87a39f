#pragma once

#include <Eigen/Core>
#include <vector>

#include "slam/loops/loop_closure.h"

namespace parkade {

/// How much of each loop's information counts: a keyframe is compared with several neighbors of
/// another, and its own neighbors see the same points in much the same way, so that their errors
/// are alike. Loops whose ends lie near each other along the drive share what they know: 1 / (1 +
/// sum of the correlations with the others), a correlation that falls linearly from
/// kNeighborCorrelation to nothing at `reach`. Loops that were not measured have 0.
///
/// \param reach  [m] along the drive, both ends together
std::vector<double> SharesOf(const std::vector<LoopEvidence>& loops,
                             const std::vector<RigKeyframe>& keyframes, double reach);

/// The same for loops of which only the ends' distances along the drives are known.
/// \param ways  [m] along either drive, of loops that count
std::vector<double> SharesOf(const std::vector<Eigen::Vector2d>& ways, double reach);

/// Correlation of the errors of two loops at the same keyframes. Measured on 370 loops of 12
/// rendered drives:
/// 0.37 below 2 m, 0.19 from 2 to 4 m, 0.12 from 4 to 6 m, 0.05 beyond.
inline constexpr double kNeighborCorrelation = 0.4;

}  // namespace parkade
