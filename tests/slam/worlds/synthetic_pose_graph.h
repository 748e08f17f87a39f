#pragma once

#include <cstdint>

#include "slam/pose_graph/pose_graph.h"

namespace parkade {

/// How a made-up drive over a car park looks: lanes up and down that are driven twice, so that
/// there are loops.
struct SyntheticGraphOptions {
  int num_poses = 400;
  double translation_sigma = 0.05;  ///< [m] per edge
  double rotation_sigma = 0.01;     ///< [rad] per edge
  double wrong_share = 0;           ///< of all loops
  bool is_planar = false;
  std::uint32_t seed = 1;
};

struct SyntheticGraph {
  PoseGraph graph;            ///< vertices along the noisy odometry
  std::vector<Rigid3> truth;  ///< per vertex
  size_t num_right_loops = 0, num_wrong_loops = 0;
};

/// Edges in the order odometry, right loops, wrong loops; information is the inverse of the noise's
/// covariance.
SyntheticGraph MakeSyntheticGraph(const SyntheticGraphOptions& options);

/// Adds loops between random vertices with random measurements within the extent of `placed`,
/// weighted like random other loops of `graph`, until they are `share` of all loops.
void AddWrongLoops(const std::vector<Rigid3>& placed, double share, std::uint32_t seed,
                   PoseGraph& graph);

/// Adds loops that are wrong and agree with each other, as rows of equal columns make them: `group`
/// successive vertices seem to be where others are that lie elsewhere, all by the same motion,
/// until they are `share` of all loops.
void AddAlikeStretches(const std::vector<Rigid3>& placed, double share, size_t group,
                       std::uint32_t seed, PoseGraph& graph);

/// RMSE of positions after rigid alignment [m].
double PositionError(const std::vector<Rigid3>& truth, const PoseGraph& graph);

std::vector<Rigid3> PosesOf(const PoseGraph& graph);

}  // namespace parkade
