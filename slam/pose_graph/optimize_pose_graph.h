#pragma once

#include <memory>
#include <string>

#include "slam/pose_graph/pose_graph.h"

namespace parkade {

struct PoseGraphOptions {
  std::string objective = "chordal";  ///< "chordal" or "information", see PoseGraphObjective
  /// Where the search begins: "best" (of the following, by cost), "chordal" (relaxation),
  /// "odometry" (chained edges) or "given" (the graph's own poses).
  std::string start = "best";
  int max_iterations = 100;
  double relative_tolerance = 1e-9;  ///< ends when a step lowers the cost by less than this share

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("objective", objective);
    visit("start", start);
    visit("max_iterations", max_iterations);
    visit("relative_tolerance", relative_tolerance);
  }
  void Validate() const;  ///< throws Error{kUsage}
  PoseGraphObjective Objective() const;
};

/// How a search went. Costs are sums of weighted squared errors, without a factor of one half.
struct PoseGraphSummary {
  std::string start;  ///< that was taken
  double initial_cost = 0, final_cost = 0;
  int num_iterations = 0;
  bool has_converged = false;
};

/// The least-squares problem of one graph, kept between solves whose edges have
/// different weights. Not thread-safe; Ceres uses up to NumThreads() threads.
class PoseGraphProblem {
 public:
  PoseGraphProblem(const PoseGraph& graph, PoseGraphObjective objective);
  ~PoseGraphProblem();

  /// Factors on the edges' squared errors, >= 0. Edges with 0 cost nothing in the solves that
  /// follow.
  void SetWeights(const std::vector<double>& weights);
  void SetPoses(const std::vector<Rigid3>& world_from_vertex);
  std::vector<Rigid3> Poses() const;

  /// Weighted sum of squared errors at the current poses.
  double Cost() const;
  /// Unweighted squared error of each edge at the current poses.
  std::vector<double> SquaredErrors() const;

  /// Levenberg-Marquardt from the current poses; anchors (FindAnchors) stay. Throws
  /// Error{kInvalidInput} where the numbers are beyond arithmetic.
  PoseGraphSummary Solve(int max_iterations, double relative_tolerance);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// Moves the vertices to where the weighted squared errors of the edges add up to the least;
/// anchors stay. Throws Error{kUsage} for options that are none, Error{kInvalidInput} where numbers
/// are beyond arithmetic.
PoseGraphSummary OptimizePoseGraph(const PoseGraphOptions& options, PoseGraph& graph);

}  // namespace parkade
