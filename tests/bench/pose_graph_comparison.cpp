#include <ceres/ceres.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <iostream>

#include "core/file.h"
#include "core/parallel.h"
#include "slam/g2o_file.h"
#include "slam/optimize_pose_graph.h"
#include "slam/pose_graph_start.h"

namespace parkade {
namespace {

/// An edge as one would write it for Ceres without further thought: automatic derivatives, quaternion and translation
/// as two blocks. The error is that of RelativePoseError.
struct PlainError {
  PlainError(const PoseGraphEdge& edge, const Matrix6d& square_root_weight)
      : measured(edge.from_from_to), weight(square_root_weight) {}

  template <typename T>
  bool operator()(const T* q_from, const T* t_from, const T* q_to, const T* t_to, T* residual) const {
    const Eigen::Map<const Eigen::Quaternion<T>> from(q_from), to(q_to);
    const Eigen::Map<const Eigen::Matrix<T, 3, 1>> from_at(t_from), to_at(t_to);
    const Eigen::Quaternion<T> rotation = measured.rotation.cast<T>();
    const Eigen::Quaternion<T> turn = rotation.conjugate() * (from.conjugate() * to);
    Eigen::Matrix<T, 6, 1> error;
    error.template head<3>() =
        rotation.conjugate() * (from.conjugate() * (to_at - from_at) - measured.translation.cast<T>());
    error.template tail<3>() = T(2.0) * turn.vec();
    Eigen::Map<Eigen::Matrix<T, 6, 1>>(residual, 6) = weight.cast<T>() * error;
    return true;
  }

  const Rigid3 measured;
  const Matrix6d weight;
};

double Now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

/// Ceres with its defaults, from chained odometry. Returns the seconds it took.
double SolvePlainly(PoseGraph& graph, int max_iterations) {
  const std::vector<Rigid3> start = ChainEdges(graph);
  const double begin = Now();
  std::vector<Eigen::Quaterniond> rotations;
  std::vector<Eigen::Vector3d> places;
  for (const Rigid3& pose : start) {
    rotations.push_back(pose.rotation);
    places.push_back(pose.translation);
  }
  ceres::Problem problem;
  auto* manifold = new ceres::EigenQuaternionManifold;
  for (const PoseGraphEdge& edge : graph.edges) {
    auto* cost = new ceres::AutoDiffCostFunction<PlainError, 6, 4, 3, 4, 3>(
        new PlainError(edge, SquareRootWeight(graph, edge, PoseGraphObjective::kChordal)));
    problem.AddResidualBlock(cost, nullptr, rotations[edge.from].coeffs().data(), places[edge.from].data(),
                             rotations[edge.to].coeffs().data(), places[edge.to].data());
  }
  for (Eigen::Quaterniond& rotation : rotations)
    if (problem.HasParameterBlock(rotation.coeffs().data())) problem.SetManifold(rotation.coeffs().data(), manifold);
  problem.SetParameterBlockConstant(rotations.front().coeffs().data());
  problem.SetParameterBlockConstant(places.front().data());
  ceres::Solver::Options options;
  options.max_num_iterations = max_iterations;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.num_threads = NumThreads();
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  const double seconds = Now() - begin;
  for (size_t i = 0; i < rotations.size(); ++i)
    graph.vertices[i].world_from_vertex = {rotations[i].normalized(), places[i]};
  return seconds;
}

int Run(const std::vector<std::string>& files, int max_iterations) {
  std::printf("| graph | ours: objective | s | plain Ceres from odometry: objective | s |\n|---|---|---|---|---|\n");
  for (const std::string& file : files) {
    PoseGraph graph = ReadG2o(ReadFile(file));
    PoseGraph plain = graph;
    const double begin = Now();
    OptimizePoseGraph({}, graph);
    const double seconds = Now() - begin, plain_seconds = SolvePlainly(plain, max_iterations);
    std::printf("| %s | %.6g | %.2f | %.6g | %.2f |\n", file.substr(file.rfind('/') + 1).c_str(),
                ObjectiveOf(graph, PoseGraphObjective::kChordal), seconds,
                ObjectiveOf(plain, PoseGraphObjective::kChordal), plain_seconds);
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace
}  // namespace parkade

int main(int argc, char** argv) {
  CLI::App app{"Pose graphs: parkade's optimiser beside plain Ceres.", "parkade-pose-graph-comparison"};
  std::vector<std::string> files;
  int max_iterations = 200, num_threads = 2;
  app.add_option("FILE", files, "g2o files, spatial")->required();
  app.add_option("--iterations", max_iterations, "of plain Ceres, at most")->capture_default_str();
  app.add_option("--threads", num_threads)->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    parkade::SetNumThreads(num_threads);
    return parkade::Run(files, max_iterations);
  } catch (const std::exception& error) {
    std::cerr << "parkade-pose-graph-comparison: " << error.what() << "\n";
    return 2;
  }
}
