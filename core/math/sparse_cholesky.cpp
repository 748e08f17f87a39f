#include "core/math/sparse_cholesky.h"

#include <dlfcn.h>

#include <Eigen/CholmodSupport>
#include <algorithm>
#include <cmath>
#include <optional>

#include "core/error.h"

namespace parkade {
namespace {

constexpr Eigen::Index kColumns = 32;  // solved for at a time: CHOLMOD's workspace is as wide
constexpr double kTolerance = 1e-2;    // of the energy norm
constexpr int kMaxSteps = 12;   // of conjugate gradients, which take as long as a factor then
constexpr int kLeastSteps = 3;  // before they are judged

/// CHOLMOD asks OpenMP for four threads whatever the machine has; they would wait for each other by
/// spinning.
void KeepOpenMpToCaller() {
  using SetLevels = void (*)(int);
  if (void* set_levels = dlsym(RTLD_DEFAULT, "omp_set_max_active_levels"))
    reinterpret_cast<SetLevels>(set_levels)(0);
}

}  // namespace

class CholeskySolver::Factor
    : public Eigen::CholmodSupernodalLLT<Eigen::SparseMatrix<double>, Eigen::Lower> {
 public:
  void Factorize(const Eigen::SparseMatrix<double>& a) {
    if (m_cholmodFactor == nullptr) analyzePattern(a);
    factorize(a);
    has_numbers_ = info() == Eigen::Success;
    if (!has_numbers_) LetGoOfNumbers();
    Require(has_numbers_, ErrorCode::kInternal, "the matrix is not positive definite");
  }

  void LetGoOfNumbers() {
    cholmod_change_factor(CHOLMOD_PATTERN, /*to_ll=*/1, /*to_super=*/1, /*to_packed=*/1,
                          /*to_monotonic=*/1, m_cholmodFactor, &cholmod());
    has_numbers_ = false;
  }

  Eigen::VectorXd SolveSimilar(const Eigen::SparseMatrix<double>& a, const Eigen::VectorXd& b) {
    if (has_numbers_)
      if (std::optional<Eigen::VectorXd> x = Iterate(a, b)) return *std::move(x);
    Factorize(a);
    return solve(b);
  }

 private:
  /// Nothing where `a` is not similar enough.
  std::optional<Eigen::VectorXd> Iterate(const Eigen::SparseMatrix<double>& a,
                                         const Eigen::VectorXd& b) const {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(b.size()), rest = b, solved = solve(rest),
                    direction = solved;
    double left = rest.dot(solved), energy = 0;
    for (int step = 1; step <= kMaxSteps && left > 0; ++step) {
      const Eigen::VectorXd image = a.selfadjointView<Eigen::Lower>() * direction;
      const double curvature = direction.dot(image);
      if (!(curvature > 0)) return std::nullopt;
      x += left / curvature * direction;
      // By how much x^T A x grew. M. Hestenes, E. Stiefel, theorem 6:1.
      const double growth = left / curvature * left;
      energy += growth;
      if (!std::isfinite(energy)) return std::nullopt;
      if (growth <= kTolerance * kTolerance * energy) return x;
      if (step >= kLeastSteps &&
          std::log(growth / energy) * kMaxSteps > 2 * std::log(kTolerance) * step)
        return std::nullopt;
      rest -= left / curvature * image;
      solved = solve(rest);
      const double next = rest.dot(solved);
      direction = solved + next / left * direction;
      left = next;
    }
    return left == 0 ? std::optional(std::move(x)) : std::nullopt;
  }

  bool has_numbers_ = false;
};

CholeskySolver::CholeskySolver() : factor_(std::make_unique<Factor>()) {}

CholeskySolver::~CholeskySolver() = default;

Eigen::MatrixXd CholeskySolver::Solve(const Eigen::SparseMatrix<double>& a,
                                      const Eigen::MatrixXd& b) {
  KeepOpenMpToCaller();
  factor_->Factorize(a);
  Eigen::MatrixXd x = factor_->solve(b);
  factor_->LetGoOfNumbers();
  return x;
}

Eigen::VectorXd CholeskySolver::SolveSimilar(const Eigen::SparseMatrix<double>& a,
                                             const Eigen::VectorXd& b) {
  KeepOpenMpToCaller();
  return factor_->SolveSimilar(a, b);
}

Eigen::MatrixXd CholeskySolver::InverseColumns(const Eigen::SparseMatrix<double>& a,
                                               std::span<const int> columns) {
  KeepOpenMpToCaller();
  factor_->Factorize(a);
  const auto count = static_cast<Eigen::Index>(columns.size());
  Eigen::MatrixXd inverse(a.rows(), count);
  for (Eigen::Index begin = 0; begin < count; begin += kColumns) {
    const Eigen::Index width = std::min(kColumns, count - begin);
    Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(a.rows(), width);
    for (Eigen::Index i = 0; i < width; ++i) unit(columns[static_cast<size_t>(begin + i)], i) = 1;
    inverse.middleCols(begin, width) = factor_->solve(unit);
  }
  factor_->LetGoOfNumbers();
  return inverse;
}

Eigen::MatrixXd SolveCholesky(const Eigen::SparseMatrix<double>& a, const Eigen::MatrixXd& b) {
  return CholeskySolver().Solve(a, b);
}

}  // namespace parkade
