#pragma once

#include <vector>

#include "slam/pose_graph/pose_graph.h"

namespace parkade {

/// Sets weights of 0 to 1 where those edges join parts of the graph that the others leave apart:
/// first likely ones, then those between the nearest ids, which may be odometry. Gravity, which
/// ties every vertex to the world but not to a place in it, does not join.
///
/// \param likely   one per edge, above 0 where others support it
/// \param weights  one per edge
void JoinParts(const PoseGraph& graph, const std::vector<double>& likely,
               std::vector<double>& weights);

/// Whether some of the graph's edges would join parts that those of more than half a weight leave
/// apart.
bool LeavesApart(const PoseGraph& graph, const std::vector<double>& weights);

}  // namespace parkade
