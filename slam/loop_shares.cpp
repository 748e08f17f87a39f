#include "slam/loop_shares.h"

#include <algorithm>
#include <cmath>

namespace parkade {

std::vector<double> SharesOf(const std::vector<LoopEvidence>& loops, const std::vector<Place>& places, double reach) {
  std::vector<double> shares;
  for (const LoopEvidence& loop : loops) {
    double sum = 1;
    for (const LoopEvidence& other : loops) {
      if (&other == &loop || !other.pose.rejected.empty()) continue;
      const double earlier = places[loop.earlier_place].distance - places[other.earlier_place].distance;
      const double later = places[loop.later_place].distance - places[other.later_place].distance;
      sum += kNeighbourCorrelation * std::max(0.0, 1 - std::hypot(earlier, later) / reach);
    }
    shares.push_back(loop.pose.rejected.empty() ? 1 / sum : 0);
  }
  return shares;
}

}  // namespace parkade
