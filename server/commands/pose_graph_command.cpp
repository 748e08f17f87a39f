#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "core/error.h"
#include "core/files/file.h"
#include "core/parallel.h"
#include "server/commands/commands.h"
#include "slam/pose_graph/g2o_file.h"
#include "slam/pose_graph/robust_pose_graph.h"

namespace parkade {
namespace {

using Json = nlohmann::ordered_json;

struct PoseGraphArguments {
  std::string input, output;
  std::string robust = "none";
  PoseGraphOptions options;
  int num_threads = 0;  ///< 0: all cores
  bool is_json = false;
};

double SecondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// The graph without the edges whose weight is 0.
PoseGraph AcceptedPart(PoseGraph graph, const std::vector<double>& weights) {
  size_t index = 0;
  std::erase_if(graph.edges, [&](const PoseGraphEdge&) { return weights[index++] == 0; });
  return graph;
}

Json RejectedToJson(const PoseGraph& graph, const RobustPoseGraphSummary& summary) {
  Json rejected = Json::array();
  for (size_t i = 0; i < graph.edges.size(); ++i) {
    if (summary.weights[i] != 0) continue;
    const PoseGraphEdge& edge = graph.edges[i];
    rejected.push_back({{"from", graph.vertices[edge.from].id},
                        {"to", graph.vertices[edge.to].id},
                        {"chi_squared", summary.chi_squared[i]}});
  }
  return rejected;
}

Json ReportOf(const PoseGraph& graph, const std::vector<bool>& is_trusted,
              const PoseGraphSummary& summary, double initial_cost) {
  return {{"dimension", graph.is_planar ? 2 : 3},
          {"num_vertices", graph.vertices.size()},
          {"num_edges", graph.edges.size()},
          {"num_loops", std::count(is_trusted.begin(), is_trusted.end(), false)},
          {"start", summary.start},
          {"num_iterations", summary.num_iterations},
          {"has_converged", summary.has_converged},
          {"initial_cost", initial_cost},
          {"final_cost", summary.final_cost}};
}

std::string ToText(const Json& report) {
  std::string text;
  for (const auto& [key, value] : report.items()) {
    if (value.is_structured()) continue;
    text += key + ": " + (value.is_string() ? value.get<std::string>() : value.dump()) + "\n";
  }
  return text;
}

int OptimizeFile(const PoseGraphArguments& arguments) {
  arguments.options.Validate();
  if (arguments.num_threads > 0) SetNumThreads(arguments.num_threads);
  PoseGraph graph = ReadG2o(ReadFile(arguments.input));
  std::vector<bool> is_trusted, is_left_out;
  for (const PoseGraphEdge& edge : graph.edges) is_trusted.push_back(edge.is_trusted);
  const PoseGraphObjective objective = arguments.options.Objective();
  const double initial_cost = ObjectiveOf(graph, objective);

  const auto start = std::chrono::steady_clock::now();
  Json report;
  if (arguments.robust == "gnc") {
    RobustPoseGraphOptions options;
    options.graph = arguments.options;
    const RobustPoseGraphSummary summary = OptimizePoseGraphRobustly(options, graph);
    const double seconds = SecondsSince(start);
    report = ReportOf(graph, is_trusted, summary.solve, initial_cost);
    report["sesync_objective"] =
        ObjectiveOf(AcceptedPart(graph, summary.weights), PoseGraphObjective::kChordal);
    report["seconds"] = seconds;
    for (const double weight : summary.weights) is_left_out.push_back(weight == 0);
    report["num_rejected"] = std::count(is_left_out.begin(), is_left_out.end(), true);
    report["noise_scale"] = summary.noise_scale;
    report["num_rounds"] = summary.num_rounds;
    report["rejected"] = RejectedToJson(graph, summary);
  } else {
    const PoseGraphSummary summary = OptimizePoseGraph(arguments.options, graph);
    const double seconds = SecondsSince(start);
    report = ReportOf(graph, is_trusted, summary, initial_cost);
    report["sesync_objective"] = ObjectiveOf(graph, PoseGraphObjective::kChordal);
    report["seconds"] = seconds;
  }
  WriteFileAtomically(arguments.output, WriteG2o(graph, is_left_out));
  std::printf("%s", arguments.is_json ? (report.dump(2) + "\n").c_str() : ToText(report).c_str());
  return 0;
}

}  // namespace

void AddPoseGraphCommand(CLI::App& app, Action& action) {
  const auto arguments = std::make_shared<PoseGraphArguments>();
  CLI::App* command =
      app.add_subcommand("pose-graph",
                         "Optimize a pose graph (g2o; SE2 or SE3). Prints costs without a factor "
                         "of one half: of the chosen objective, "
                         "and SE-Sync's; with --robust gnc both are of the accepted edges");
  command->add_option("IN", arguments->input, "pose graph (g2o)")->required();
  command
      ->add_option("--out", arguments->output,
                   "where to write the optimized graph; rejected edges become comments")
      ->required();
  command
      ->add_option("--robust", arguments->robust,
                   "gnc: graduated non-convexity over edges between ids that are not consecutive; "
                   "none: believe all")
      ->check(CLI::IsMember({"gnc", "none"}))
      ->capture_default_str();
  command
      ->add_option("--objective", arguments->options.objective,
                   "chordal: SE-Sync's, one weight per edge for rotation and one for translation; "
                   "information: the "
                   "whole matrix of each edge")
      ->check(CLI::IsMember({"chordal", "information"}))
      ->capture_default_str();
  command
      ->add_option("--start", arguments->options.start,
                   "where the search begins: chordal relaxation, chained odometry, the poses "
                   "given, or the best of them")
      ->check(CLI::IsMember({"best", "chordal", "odometry", "given"}))
      ->capture_default_str();
  command->add_option("--threads", arguments->num_threads, "threads; default: all cores")
      ->check(CLI::PositiveNumber);
  command->add_flag("--json", arguments->is_json, "print JSON");
  command->callback(
      [arguments, &action] { action = [arguments] { return OptimizeFile(*arguments); }; });
}

}  // namespace parkade
