#pragma once

#include <cstdint>
#include <vector>

#include "core/trajectory.h"
#include "slam/places/rig_keyframe.h"
#include "slam/pose_graph/pose_graph.h"

namespace parkade {

struct LoopOptions;

inline constexpr std::int64_t kIdsPerDrive =
    1'000'000'000;  ///< keeps the ids of several drives in one graph apart

/// The random walk of AddKeyframes as the odometry itself knows it, see LoopOptions.
LoopOptions WithDriftOf(const Trajectory& odometry, LoopOptions options);

/// A graph that holds nothing but the world, its vertex 0.
PoseGraph WorldGraph();

/// Adds the keyframes of one drive to a graph of WorldGraph: a vertex each, trusted edges of
/// odometry from one to the next and of gravity from the world. Returns the index of the first
/// keyframe's vertex; the others follow.
///
/// \param world_from_keyframe  where the keyframes begin; level
/// \param first_id of the first keyframe; the others count up. Ids of several drives must lie far
/// apart.
size_t AddKeyframes(const std::vector<RigKeyframe>& keyframes,
                    const std::vector<Rigid3>& world_from_keyframe, const LoopOptions& options,
                    std::int64_t first_id, PoseGraph& graph);

}  // namespace parkade
