#include "slam/factors/factor_graph.h"

#include <ceres/solver.h>

#include <algorithm>
#include <chrono>

#include "core/parallel.h"
#include "slam/factors/imu_cost.h"
#include "slam/factors/measurement_model.h"
#include "slam/factors/relative_pose_cost.h"
#include "slam/factors/standstill_cost.h"
#include "slam/factors/wheel_cost.h"
#include "slam/schur/schur_solver.h"

namespace parkade {

FactorGraph::FactorGraph(ParameterArena& arena, double bearing_weight)
    : arena_(arena),
      loss_(kRobustWidth),
      bearing_loss_(&loss_, bearing_weight, ceres::DO_NOT_TAKE_OWNERSHIP),
      problem_(ProblemOptions(&views_)) {}

void FactorGraph::ViewUpdater::Update() {
  constexpr size_t kPiece = 256;
  ParallelFor((views_.size() + kPiece - 1) / kPiece, [this](size_t piece) {
    for (size_t i = piece * kPiece; i < std::min((piece + 1) * kPiece, views_.size()); ++i)
      views_[i]->Update();
  });
}

ceres::Problem::Options FactorGraph::ProblemOptions(ceres::EvaluationCallback* callback) {
  ceres::Problem::Options options;
  options.cost_function_ownership = options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.disable_all_safety_checks = true;
  options.evaluation_callback = callback;
  return options;
}

void FactorGraph::AddBlock(double* block, int size, ceres::Manifold* manifold, bool is_free) {
  if (Contains(block)) return;
  problem_.AddParameterBlock(block, size, manifold);
  if (is_free)
    free_states_.push_back(block);
  else
    problem_.SetParameterBlockConstant(block);
}

void FactorGraph::AddFactor(std::unique_ptr<ceres::CostFunction> cost, ceres::LossFunction* loss,
                            const std::vector<double*>& blocks) {
  problem_.AddResidualBlock(cost.get(), loss, blocks);
  costs_.push_back(std::move(cost));
}

void FactorGraph::AddCamera(const CameraBlocks& camera, bool frees_extrinsics, bool frees_timing) {
  AddBlock(camera.extrinsics, kPoseSize, &manifold_, frees_extrinsics);
  AddBlock(camera.timing, kTimingSize, nullptr, frees_timing);
}

void FactorGraph::AddLandmark(double* landmark) {
  if (Contains(landmark)) return;
  problem_.AddParameterBlock(landmark, kLandmarkSize);
  landmarks_.push_back(landmark);
}

void FactorGraph::AddPrior(const LinearPrior& prior, const std::vector<double*>& blocks) {
  AddFactor(std::make_unique<LinearPriorCost>(&prior), nullptr, blocks);
}

void FactorGraph::AddImu(const ImuPreintegration& imu, const NodeBlocks& i, const NodeBlocks& j) {
  AddFactor(std::make_unique<ImuCost>(&imu), nullptr, {i.pose, i.motion, j.pose, j.motion});
}

void FactorGraph::AddWheels(const WheelPreintegration& wheels, const NodeBlocks& i,
                            const NodeBlocks& j, double* wheel_scale) {
  AddFactor(std::make_unique<WheelCost>(wheels), &loss_, {i.pose, i.motion, j.pose, wheel_scale});
}

void FactorGraph::AddStandstill(const NodeBlocks& i, const NodeBlocks& j) {
  AddFactor(std::make_unique<StandstillCost>(), nullptr, {i.pose, j.pose, j.motion});
}

void FactorGraph::AddLoop(const Rigid3& from_from_to, const Matrix6d& square_root_weight,
                          double* from_pose, double* to_pose) {
  AddFactor(std::make_unique<RelativePoseCost>(from_from_to, square_root_weight), &loss_,
            {from_pose, to_pose});
}

void FactorGraph::AddFix(const AntennaFix& fix, double* pose_i, double* pose_j,
                         double* site_from_odom) {
  AddFactor(std::make_unique<GnssCost>(fix), &loss_, {pose_i, pose_j, site_from_odom});
}

void FactorGraph::AddBearing(BearingCost& bearing, ImageView& view, double* landmark) {
  views_.Add(view);
  std::vector<double*> blocks = view.Blocks();
  blocks.push_back(landmark);
  problem_.AddResidualBlock(&bearing, &bearing_loss_, blocks);
  ++num_bearings_;
}

double FactorGraph::Cost() {
  double cost = 0;
  problem_.Evaluate({}, &cost, nullptr, nullptr, nullptr);
  return cost;
}

SolveSummary FactorGraph::Solve(const GraphSolverOptions& options) {
  const std::vector<double> before = arena_.values();
  SolveSummary summary = options.solver == GraphSolverOptions::Solver::kSchurSolver
                             ? SolveBySchur(options)
                             : SolveByCeres(options);
  if (!summary.is_usable || !arena_.IsFinite()) arena_.Restore(before);
  summary.landmarks = static_cast<int>(landmarks_.size());
  summary.bearings = num_bearings_;
  return summary;
}

SolveSummary FactorGraph::SolveBySchur(const GraphSolverOptions& options) {
  static_assert(kLandmarkSize == kSchurLandmarkSize);
  const auto start = std::chrono::steady_clock::now();
  SchurSolver solver(problem_, landmarks_, [this] { views_.Update(); });
  const SchurSummary solved =
      solver.Solve({options.max_iterations, options.function_tolerance, options.trust_region});
  SolveSummary summary;
  summary.iterations = solved.iterations;
  summary.final_cost = solved.final_cost;
  summary.is_usable = solved.is_usable;
  summary.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return summary;
}

SolveSummary FactorGraph::SolveByCeres(const GraphSolverOptions& options) {
  ceres::Solver::Options solver;
  solver.linear_solver_type = options.solver == GraphSolverOptions::Solver::kCeresDense
                                  ? ceres::DENSE_SCHUR
                                  : ceres::SPARSE_SCHUR;
  solver.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
  solver.max_num_iterations = options.max_iterations;
  solver.num_threads = 1;  // sums keep their order
  solver.function_tolerance = options.function_tolerance;
  solver.initial_trust_region_radius = options.trust_region;
  solver.logging_type = ceres::SILENT;
  solver.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  for (double* block : free_states_) solver.linear_solver_ordering->AddElementToGroup(block, 1);
  for (double* block : landmarks_) solver.linear_solver_ordering->AddElementToGroup(block, 0);
  ceres::Solver::Summary solved;
  ceres::Solve(solver, &problem_, &solved);
  SolveSummary summary;
  summary.iterations = static_cast<int>(solved.iterations.size()) - 1;
  summary.seconds = solved.total_time_in_seconds;
  summary.final_cost = solved.final_cost;
  summary.is_usable = solved.IsSolutionUsable();
  return summary;
}

}  // namespace parkade
