#include <ceres/ceres.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <iostream>

#include "core/files/file.h"
#include "core/parallel.h"
#include "slam/pose_graph/g2o_file.h"
#include "slam/pose_graph/optimize_pose_graph.h"
#include "slam/pose_graph/pose_graph_start.h"
#include "slam/pose_graph/robust_pose_graph.h"
#include "tests/slam/worlds/synthetic_pose_graph.h"

namespace parkade {
namespace {

/// An edge as one would write it for Ceres without further thought: automatic derivatives,
/// quaternion and translation as two blocks. The error is that of RelativePoseError.
struct PlainError {
  PlainError(const PoseGraphEdge& edge, const Matrix6d& square_root_weight)
      : measured(edge.from_from_to), weight(square_root_weight) {}

  template <typename T>
  bool operator()(const T* q_from, const T* t_from, const T* q_to, const T* t_to,
                  T* residual) const {
    const Eigen::Map<const Eigen::Quaternion<T>> from(q_from), to(q_to);
    const Eigen::Map<const Eigen::Matrix<T, 3, 1>> from_at(t_from), to_at(t_to);
    const Eigen::Quaternion<T> rotation = measured.rotation.cast<T>();
    const Eigen::Quaternion<T> turn = rotation.conjugate() * (from.conjugate() * to);
    Eigen::Matrix<T, 6, 1> error;
    error.template head<3>() = rotation.conjugate() * (from.conjugate() * (to_at - from_at) -
                                                       measured.translation.cast<T>());
    error.template tail<3>() = T(2.0) * turn.vec();
    Eigen::Map<Eigen::Matrix<T, 6, 1>>(residual, 6) = weight.cast<T>() * error;
    return true;
  }

  const Rigid3 measured;
  const Matrix6d weight;
};

std::string NameOf(const std::string& file) { return file.substr(file.rfind('/') + 1); }

/// [s] of processor time, which other programs on the machine do not lengthen.
double Now() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// Ceres with its defaults, from chained odometry. Returns the seconds it took.
double SolvePlainly(PoseGraph& graph, int max_iterations) {
  const std::vector<Rigid3> start = ChainEdges(graph);
  const double begin = Now();
  std::vector<Eigen::Quaterniond> rotations;
  std::vector<Eigen::Vector3d> keyframes;
  for (const Rigid3& pose : start) {
    rotations.push_back(pose.rotation);
    keyframes.push_back(pose.translation);
  }
  ceres::Problem problem;
  auto* manifold = new ceres::EigenQuaternionManifold;
  for (const PoseGraphEdge& edge : graph.edges) {
    auto* cost = new ceres::AutoDiffCostFunction<PlainError, 6, 4, 3, 4, 3>(
        new PlainError(edge, SquareRootWeight(graph, edge, PoseGraphObjective::kChordal)));
    problem.AddResidualBlock(cost, nullptr, rotations[edge.from].coeffs().data(),
                             keyframes[edge.from].data(), rotations[edge.to].coeffs().data(),
                             keyframes[edge.to].data());
  }
  for (Eigen::Quaterniond& rotation : rotations)
    if (problem.HasParameterBlock(rotation.coeffs().data()))
      problem.SetManifold(rotation.coeffs().data(), manifold);
  problem.SetParameterBlockConstant(rotations.front().coeffs().data());
  problem.SetParameterBlockConstant(keyframes.front().data());
  ceres::Solver::Options options;
  options.max_num_iterations = max_iterations;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.num_threads = NumThreads();
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  const double seconds = Now() - begin;
  for (size_t i = 0; i < rotations.size(); ++i)
    graph.vertices[i].world_from_vertex = {rotations[i].normalized(), keyframes[i]};
  return seconds;
}

struct CommandLine {
  std::vector<std::string> files;
  std::vector<double> wrong_shares;
  std::vector<std::uint32_t> seeds = {1};
  size_t group = 1;
  int max_iterations = 200, num_threads = 1;
};

void CompareWithPlainCeres(const CommandLine& line) {
  std::printf(
      "| graph | ours: objective | s | plain Ceres from odometry: objective | s "
      "|\n|---|---|---|---|---|\n");
  for (const std::string& file : line.files) {
    PoseGraph graph = ReadG2o(ReadFile(file));
    PoseGraph plain = graph;
    const double begin = Now();
    OptimizePoseGraph({}, graph);
    const double seconds = Now() - begin, plain_seconds = SolvePlainly(plain, line.max_iterations);
    std::printf("| %s | %.6g | %.2f | %.6g | %.2f |\n", NameOf(file).c_str(),
                ObjectiveOf(graph, PoseGraphObjective::kChordal), seconds,
                ObjectiveOf(plain, PoseGraphObjective::kChordal), plain_seconds);
    std::fflush(stdout);
  }
}

/// Wrong loops among all loops: how far the robust result lies from the optimum without them.
void CompareWithClean(const CommandLine& line) {
  std::printf(
      "| graph | wrong loops | seed | off the clean optimum, m (odometry) | wrong kept | right "
      "lost | noise | s |\n");
  std::printf("|---|---|---|---|---|---|---|---|\n");
  for (const std::string& file : line.files) {
    PoseGraph clean = ReadG2o(ReadFile(file));
    OptimizePoseGraph({}, clean);
    PoseGraph odometry = clean;
    OptimizePoseGraph({.start = "odometry", .max_iterations = 0}, odometry);
    const double of_odometry = PositionError(PosesOf(clean), odometry);
    for (const double share : line.wrong_shares) {
      for (const std::uint32_t seed : line.seeds) {
        PoseGraph graph = ReadG2o(ReadFile(file));
        const size_t num_right = graph.edges.size();
        if (line.group > 1) {
          AddAlikeStretches(PosesOf(clean), share, line.group, seed, graph);
        } else {
          AddWrongLoops(PosesOf(clean), share, seed, graph);
        }
        const double begin = Now();
        const RobustPoseGraphSummary summary = OptimizePoseGraphRobustly({}, graph);
        const double seconds = Now() - begin;
        const auto is_kept = [](double weight) { return weight > 0.5; };
        const auto middle = summary.weights.begin() + static_cast<std::ptrdiff_t>(num_right);
        const auto num_wrong_kept = std::count_if(middle, summary.weights.end(), is_kept);
        const auto num_right_lost = middle - summary.weights.begin() -
                                    std::count_if(summary.weights.begin(), middle, is_kept);
        std::printf("| %s | %zu (%.0f %%) | %u | %.3g (%.3g) | %td | %td | %.3g | %.1f |\n",
                    NameOf(file).c_str(), graph.edges.size() - num_right, 100 * share, seed,
                    PositionError(PosesOf(clean), graph), of_odometry, num_wrong_kept,
                    num_right_lost, summary.noise_scale, seconds);
        std::fflush(stdout);
      }
    }
  }
}

}  // namespace
}  // namespace parkade

int main(int argc, char** argv) {
  CLI::App app{
      "Pose graphs: parkade's optimizer beside plain Ceres, or with wrong loops beside itself "
      "without.",
      "parkade-pose-graph-comparison"};
  parkade::CommandLine line;
  app.add_option("FILE", line.files, "g2o files, spatial")->required();
  app.add_option("--wrong", line.wrong_shares,
                 "Shares of wrong loops among all loops, to be added at random")
      ->delimiter(',')
      ->check(CLI::Range(0.0, 0.95));
  app.add_option("--alike", line.group,
                 "Wrong loops come in groups of so many that agree with each other")
      ->check(CLI::Range(1, 1000));
  app.add_option("--seeds", line.seeds, "of the wrong loops")->delimiter(',');
  app.add_option("--iterations", line.max_iterations, "of plain Ceres, at most")
      ->capture_default_str();
  app.add_option("--threads", line.num_threads)->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    parkade::SetNumThreads(line.num_threads);
    if (line.wrong_shares.empty()) {
      parkade::CompareWithPlainCeres(line);
    } else {
      parkade::CompareWithClean(line);
    }
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "parkade-pose-graph-comparison: " << error.what() << "\n";
    return 2;
  }
}
