#include "core/math/sparse_cholesky.h"

#include <dlfcn.h>

#include <Eigen/CholmodSupport>

#include "core/error.h"

namespace parkade {
namespace {

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
  Eigen::MatrixXd Solve(const Eigen::SparseMatrix<double>& a, const Eigen::MatrixXd& b) {
    if (m_cholmodFactor == nullptr) analyzePattern(a);
    factorize(a);
    Require(info() == Eigen::Success, ErrorCode::kInternal, "the matrix is not positive definite");
    Eigen::MatrixXd x = solve(b);
    cholmod_change_factor(CHOLMOD_PATTERN, /*to_ll=*/1, /*to_super=*/1, /*to_packed=*/1,
                          /*to_monotonic=*/1, m_cholmodFactor, &cholmod());
    return x;
  }
};

CholeskySolver::CholeskySolver() : factor_(std::make_unique<Factor>()) {}

CholeskySolver::~CholeskySolver() = default;

Eigen::MatrixXd CholeskySolver::Solve(const Eigen::SparseMatrix<double>& a,
                                      const Eigen::MatrixXd& b) {
  KeepOpenMpToCaller();
  return factor_->Solve(a, b);
}

Eigen::MatrixXd SolveCholesky(const Eigen::SparseMatrix<double>& a, const Eigen::MatrixXd& b) {
  return CholeskySolver().Solve(a, b);
}

}  // namespace parkade
