#include "slam/loops/loop_shares.h"

#include <algorithm>
#include <cmath>

namespace parkade {

std::vector<double> SharesOf(const std::vector<Eigen::Vector2d>& ways, double reach) {
  std::vector<double> shares;
  for (const Eigen::Vector2d& way : ways) {
    double sum = 1 - kNeighborCorrelation;
    for (const Eigen::Vector2d& other : ways)
      sum += kNeighborCorrelation * std::max(0.0, 1 - (way - other).norm() / reach);
    shares.push_back(1 / sum);
  }
  return shares;
}

std::vector<double> SharesOf(const std::vector<LoopEvidence>& loops,
                             const std::vector<RigKeyframe>& keyframes, double reach) {
  std::vector<Eigen::Vector2d> ways;
  for (const LoopEvidence& loop : loops)
    if (loop.pose.rejected.empty())
      ways.emplace_back(keyframes[loop.earlier_keyframe].distance,
                        keyframes[loop.later_keyframe].distance);
  const std::vector<double> of_measured = SharesOf(ways, reach);
  auto share = of_measured.begin();
  std::vector<double> shares;
  for (const LoopEvidence& loop : loops)
    shares.push_back(loop.pose.rejected.empty() ? *share++ : 0);
  return shares;
}

}  // namespace parkade
