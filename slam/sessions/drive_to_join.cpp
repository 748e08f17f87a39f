#include "slam/sessions/drive_to_join.h"

#include <algorithm>

namespace parkade {

int DrivePair::num_accepted() const {
  return static_cast<int>(std::count_if(weights.begin(), weights.end(), [](double weight) { return weight > 0.5; }));
}

void AddClosedLoops(const DriveToJoin& drive, size_t first_vertex, PoseGraph& graph) {
  const std::vector<Place>& places = drive.places;
  for (const LoopEvidence& loop : drive.loops.loops) {
    if (loop.weight < 0.5 || loop.pose.information.diagonal().minCoeff() <= 0) continue;
    graph.edges.push_back(
        {first_vertex + loop.earlier_place, first_vertex + loop.later_place,
         places[loop.earlier_place].odom_from_place.Inverse() * places[loop.later_place].odom_from_place,
         loop.share * loop.pose.information, true});
  }
}

}  // namespace parkade
