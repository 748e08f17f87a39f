#pragma once

#include "slam/pose_graph/optimize_pose_graph.h"

namespace parkade {

struct RobustPoseGraphOptions {
  PoseGraphOptions graph;
  double mu_step = 2;  ///< factor on the control parameter per round: smaller is slower and surer
  bool adapts_noise = true; /**< Where the accepted loops agree far better than their information
                               says, the bound is lowered to what they show, never raised. */

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("graph", graph);
    visit("mu_step", mu_step);
    visit("adapts_noise", adapts_noise);
  }
  void Validate() const;  ///< throws Error{kUsage}
};

struct RobustPoseGraphSummary {
  PoseGraphSummary solve;           ///< the last solve, with the accepted edges only
  std::vector<double> weights;      ///< per edge, 0 rejected or 1 accepted; trusted edges have 1
  std::vector<double> chi_squared;  ///< per edge, squared error at the result, by the objective
  double noise_scale = 1;  ///< factor on all sigmas, at most 1, with which the bound was set
  int num_rounds = 0;      ///< weighted solves of the continuation
};

/// Does what OptimizePoseGraph does where edges that are not trusted may be wrong: truncated least
/// squares by graduated non-convexity. H. Yang et al., "Graduated Non-Convexity for Robust Spatial
/// Perception", RA-L 2020, eq. 12-14, down to truncation at the 99 % quantile of chi^2; started
/// from the loops that support each other (FindSupportedLoops), and where there are few loops also
/// from all of them: the lower truncated cost wins.
RobustPoseGraphSummary OptimizePoseGraphRobustly(const RobustPoseGraphOptions& options,
                                                 PoseGraph& graph);

}  // namespace parkade
