#include "slam/pose_graph/optimize_pose_graph.h"

#include "core/error.h"
#include "slam/pose_graph/pose_graph_start.h"

namespace parkade {

void PoseGraphOptions::Validate() const {
  Require(objective == "chordal" || objective == "information", ErrorCode::kUsage,
          "pose graph objective '" + objective + "' is neither chordal nor information");
  Require(start == "best" || start == "chordal" || start == "odometry" || start == "given",
          ErrorCode::kUsage,
          "pose graph start '" + start + "' is neither best, chordal, odometry nor given");
  Require(max_iterations >= 0, ErrorCode::kUsage,
          "max_iterations of a pose graph must not be negative");
  Require(relative_tolerance > 0, ErrorCode::kUsage,
          "relative_tolerance of a pose graph must be positive");
}

PoseGraphObjective PoseGraphOptions::Objective() const {
  return objective == "chordal" ? PoseGraphObjective::kChordal : PoseGraphObjective::kInformation;
}

namespace {

struct Start {
  std::string name;
  std::vector<Rigid3> poses;
};

std::vector<Start> StartsOf(const PoseGraph& graph, const std::string& wanted,
                            const PoseGraphProblem& problem) {
  std::vector<Start> starts;
  const auto wants = [&wanted](const char* name) { return wanted == "best" || wanted == name; };
  if (wants("chordal")) starts.push_back({"chordal", RelaxChordally(graph)});
  if (wants("odometry")) starts.push_back({"odometry", ChainEdges(graph)});
  if (wants("given")) starts.push_back({"given", problem.Poses()});
  // The relaxation has no answer where edges without weight alone hold a pose: chained edges always
  // have one.
  if (wanted == "chordal" && starts.front().poses.empty())
    starts = {{"odometry", ChainEdges(graph)}};
  std::erase_if(starts, [](const Start& start) { return start.poses.empty(); });
  return starts;
}

}  // namespace

PoseGraphSummary OptimizePoseGraph(const PoseGraphOptions& options, PoseGraph& graph) {
  options.Validate();
  PoseGraphProblem problem(graph, options.Objective());
  const std::vector<Start> starts = StartsOf(graph, options.start, problem);
  const Start* best = nullptr;
  double best_cost = 0;
  for (const Start& start : starts) {
    problem.SetPoses(start.poses);
    const double cost = problem.Cost();
    if (best && !(cost < best_cost)) continue;
    best = &start;
    best_cost = cost;
  }
  problem.SetPoses(best->poses);
  PoseGraphSummary summary = problem.Solve(options.max_iterations, options.relative_tolerance);
  summary.start = best->name;
  const std::vector<Rigid3> poses = problem.Poses();
  for (size_t i = 0; i < poses.size(); ++i) graph.vertices[i].world_from_vertex = poses[i];
  return summary;
}

}  // namespace parkade
