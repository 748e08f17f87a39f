#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include "core/error.h"
#include "core/parallel.h"
#include "slam/factors/relative_pose_cost.h"
#include "slam/pose_graph/optimize_pose_graph.h"

namespace parkade {
namespace {

/// A loss that multiplies by a weight, which may change between solves.
class WeightLoss final : public ceres::LossFunction {
 public:
  explicit WeightLoss(const double* weight) : weight_(weight) {}
  void Evaluate(double squared_error, double rho[3]) const override {
    rho[0] = *weight_ * squared_error;
    rho[1] = *weight_;
    rho[2] = 0;
  }

 private:
  const double* weight_;
};

}  // namespace

struct PoseGraphProblem::Implementation {
  const PoseGraph& graph;
  std::vector<std::array<double, kPoseSize>> poses;
  std::vector<double> weights;
  std::vector<std::unique_ptr<RelativePoseCost>> costs;
  std::vector<std::unique_ptr<WeightLoss>> losses;
  PoseManifold spatial;
  PlanarPoseManifold planar;
  std::unique_ptr<ceres::Problem> problem;  // last: it points to all the others
};

PoseGraphProblem::PoseGraphProblem(const PoseGraph& graph, PoseGraphObjective objective)
    : implementation_(new Implementation{graph, {}, {}, {}, {}, {}, {}, nullptr}) {
  Implementation& own = *implementation_;
  own.poses.resize(graph.vertices.size());
  for (size_t i = 0; i < own.poses.size(); ++i)
    PoseToParameters(graph.vertices[i].world_from_vertex, own.poses[i].data());
  own.weights.resize(graph.edges.size());
  for (size_t i = 0; i < graph.edges.size(); ++i) {
    const Matrix6d root = SquareRootWeight(graph, graph.edges[i], objective);
    own.costs.push_back(std::make_unique<RelativePoseCost>(graph.edges[i].from_from_to, root));
    own.losses.push_back(std::make_unique<WeightLoss>(&own.weights[i]));
  }
  SetWeights(std::vector<double>(graph.edges.size(), 1));
}

PoseGraphProblem::~PoseGraphProblem() = default;

void PoseGraphProblem::SetWeights(const std::vector<double>& weights) {
  Implementation& own = *implementation_;
  own.weights = weights;
  ceres::Problem::Options options;
  options.cost_function_ownership = options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.disable_all_safety_checks = true;
  own.problem = std::make_unique<ceres::Problem>(options);
  ceres::Manifold* const manifold = own.graph.is_planar
                                        ? static_cast<ceres::Manifold*>(&own.planar)
                                        : static_cast<ceres::Manifold*>(&own.spatial);
  for (auto& pose : own.poses) own.problem->AddParameterBlock(pose.data(), kPoseSize, manifold);
  const std::vector<bool> anchors = FindAnchors(own.graph);
  for (size_t i = 0; i < anchors.size(); ++i)
    if (anchors[i]) own.problem->SetParameterBlockConstant(own.poses[i].data());
  for (size_t i = 0; i < own.costs.size(); ++i) {
    if (weights[i] == 0) continue;
    const PoseGraphEdge& edge = own.graph.edges[i];
    own.problem->AddResidualBlock(own.costs[i].get(), own.losses[i].get(),
                                  own.poses[edge.from].data(), own.poses[edge.to].data());
  }
}

void PoseGraphProblem::SetPoses(const std::vector<Rigid3>& world_from_vertex) {
  for (size_t i = 0; i < world_from_vertex.size(); ++i)
    PoseToParameters(world_from_vertex[i], implementation_->poses[i].data());
}

std::vector<Rigid3> PoseGraphProblem::Poses() const {
  std::vector<Rigid3> poses;
  for (const auto& pose : implementation_->poses) poses.push_back(PoseFromParameters(pose.data()));
  return poses;
}

std::vector<double> PoseGraphProblem::SquaredErrors() const {
  const Implementation& own = *implementation_;
  std::vector<double> squared_errors;
  for (size_t i = 0; i < own.costs.size(); ++i) {
    const PoseGraphEdge& edge = own.graph.edges[i];
    const double* const parameters[] = {own.poses[edge.from].data(), own.poses[edge.to].data()};
    Vector6d residual;
    own.costs[i]->Evaluate(parameters, residual.data(), nullptr);
    squared_errors.push_back(residual.squaredNorm());
  }
  return squared_errors;
}

double PoseGraphProblem::Cost() const {
  const std::vector<double> squared_errors = SquaredErrors();
  double cost = 0;
  for (size_t i = 0; i < squared_errors.size(); ++i)
    cost += implementation_->weights[i] * squared_errors[i];
  return cost;
}

PoseGraphSummary PoseGraphProblem::Solve(int max_iterations, double relative_tolerance) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
  options.max_num_iterations = max_iterations;
  options.function_tolerance = relative_tolerance;
  options.gradient_tolerance = options.parameter_tolerance = 1e-14;
  // Nearly Gauss-Newton steps: the usual damping of 1e-4 holds back the long, soft bends of a
  // chain.
  options.initial_trust_region_radius = 1e8;
  options.num_threads = NumThreads();
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary ceres_summary;
  ceres::Solve(options, implementation_->problem.get(), &ceres_summary);
  Require(ceres_summary.IsSolutionUsable() && std::isfinite(ceres_summary.final_cost),
          ErrorCode::kInvalidInput,
          "the pose graph's numbers are beyond arithmetic: it has no solution");

  PoseGraphSummary summary;
  summary.initial_cost = 2 * ceres_summary.initial_cost;
  summary.final_cost = 2 * ceres_summary.final_cost;
  summary.num_iterations =
      ceres_summary.num_successful_steps + ceres_summary.num_unsuccessful_steps - 1;
  summary.has_converged = ceres_summary.termination_type == ceres::CONVERGENCE;
  return summary;
}

}  // namespace parkade
