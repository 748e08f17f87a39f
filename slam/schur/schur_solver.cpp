#include "slam/schur/schur_solver.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/parallel.h"

namespace parkade {
namespace {

// As Ceres has them.
constexpr double kMinRelativeFall = 1e-3;  // of the cost against the linearized one's
constexpr double kMaxRadius = 1e16, kMinRadius = 1e-32;
constexpr int kMaxFailures = 5;  // steps in a row that cannot be computed

constexpr size_t kBatch = 16;  // chunks summed up at a time, some 1 MB each

}  // namespace

SchurSolver::SchurSolver(const ceres::Problem& problem, const std::vector<double*>& landmarks,
                         std::function<void()> prepare)
    : structure_(problem, landmarks),
      system_(structure_),
      prepare_(std::move(prepare)),
      eliminated_(structure_.chunks.size()) {
  damping_.scales.resize(structure_.num_landmarks, Eigen::Vector3d::Zero());
}

double SchurSolver::Cost() const {
  prepare_();
  const std::vector<double> costs = ParallelMap(
      structure_.chunks.size(), [&](size_t i) { return CostOf(structure_, structure_.chunks[i]); });
  double sum = 0;
  for (const double cost : costs) sum += cost;
  return sum;
}

bool SchurSolver::Linearize(double radius) {
  damping_.radius = radius;
  system_.SetZero();
  bool is_finite = true;
  for (size_t begin = 0; begin < structure_.chunks.size(); begin += kBatch) {
    const size_t count = std::min(kBatch, structure_.chunks.size() - begin);
    std::vector<SchurSums> sums = ParallelMap(
        count, [&](size_t i) { return SumUp(structure_, structure_.chunks[begin + i], damping_); });
    for (size_t i = 0; i < count; ++i) {
      system_.Add(begin + i, sums[i]);
      eliminated_[begin + i] = std::move(sums[i].eliminated);
      is_finite = is_finite && sums[i].is_finite;
    }
  }
  if (scales_.size() == 0) scales_ = system_.squared_norms().unaryExpr(&ScaleOf);
  return is_finite;
}

std::optional<SchurSolver::Step> SchurSolver::FindStep(double radius) {
  if (!Linearize(radius)) return std::nullopt;
  Eigen::VectorXd damping(structure_.num_columns);
  for (Eigen::Index i = 0; i < damping.size(); ++i)
    damping[i] = DampingOf(system_.squared_norms()[i], scales_[i], radius);
  std::optional<Eigen::VectorXd> of_states = system_.Solve(damping);
  if (!of_states) return std::nullopt;
  Step step{std::move(*of_states), {}, 0};
  step.landmarks.resize(structure_.num_landmarks);
  const std::vector<double> falls = ParallelMap(structure_.chunks.size(), [&](size_t i) {
    return BackSubstitute(structure_, structure_.chunks[i], eliminated_[i], step.states,
                          step.landmarks);
  });
  // -g x - x H x / 2, where (H + D) x = -g, or at least x (H + D) x = -g x, as conjugate gradients
  // keep it.
  step.fall =
      (step.states.dot(damping.cwiseProduct(step.states)) - step.states.dot(system_.gradient())) /
      2;
  for (const double fall : falls) step.fall += fall;
  if (!(step.fall > 0)) return std::nullopt;
  return step;
}

std::vector<double> SchurSolver::Values() const {
  std::vector<double> values;
  for (const SchurState& state : structure_.states)
    values.insert(values.end(), state.values, state.values + state.size);
  for (size_t i = 0; i < structure_.num_landmarks; ++i) {
    const double* landmark = structure_.groups[i].landmark;
    values.insert(values.end(), landmark, landmark + kSchurLandmarkSize);
  }
  return values;
}

void SchurSolver::SetValues(const std::vector<double>& values) {
  const double* next = values.data();
  for (const SchurState& state : structure_.states) {
    std::copy_n(next, state.size, state.values);
    next += state.size;
  }
  for (size_t i = 0; i < structure_.num_landmarks; ++i, next += kSchurLandmarkSize)
    std::copy_n(next, kSchurLandmarkSize, structure_.groups[i].landmark);
  prepare_();
}

void SchurSolver::Apply(const Step& step) {
  for (const SchurState& state : structure_.states) {
    const double* change = step.states.data() + state.column;
    if (state.manifold) {
      const std::vector<double> before(state.values, state.values + state.size);
      state.manifold->Plus(before.data(), change, state.values);
    } else {
      for (int k = 0; k < state.size; ++k) state.values[k] += change[k];
    }
  }
  for (size_t i = 0; i < structure_.num_landmarks; ++i)
    Eigen::Map<Eigen::Vector3d>(structure_.groups[i].landmark) += step.landmarks[i];
}

SchurSummary SchurSolver::Solve(const SchurSolverOptions& options) {
  SchurSummary summary;
  summary.final_cost = Cost();
  double radius = options.trust_region, shrink = 2;
  int num_failures = 0;
  summary.is_usable = std::isfinite(summary.final_cost);
  while (summary.is_usable && summary.iterations < options.max_iterations && radius > kMinRadius) {
    const std::optional<Step> step = FindStep(radius);
    if (!step) {
      ++summary.iterations;
      radius /= 2;
      summary.is_usable = ++num_failures < kMaxFailures;
      continue;
    }
    num_failures = 0;
    const std::vector<double> before = Values();
    Apply(*step);
    const double cost = Cost(), fall = summary.final_cost - cost;
    if (std::abs(fall) <= options.function_tolerance * summary.final_cost) {
      SetValues(before);
      break;
    }
    ++summary.iterations;
    const double ratio = fall / step->fall;
    if (ratio > kMinRelativeFall) {
      summary.final_cost = cost;
      radius = std::min(kMaxRadius, radius / std::max(1.0 / 3, 1 - std::pow(2 * ratio - 1, 3)));
      shrink = 2;
    } else {
      SetValues(before);
      radius /= std::exchange(shrink, 2 * shrink);
    }
  }
  return summary;
}

}  // namespace parkade
