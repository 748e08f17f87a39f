#include "core/sparse_cholesky.h"

#include <dlfcn.h>

#include <Eigen/CholmodSupport>

#include "core/error.h"

namespace parkade {
namespace {

/// CHOLMOD asks OpenMP for four threads whatever the machine has; they would wait for each other by spinning.
void KeepOpenMpToCaller() {
  using SetLevels = void (*)(int);
  if (void* set_levels = dlsym(RTLD_DEFAULT, "omp_set_max_active_levels")) reinterpret_cast<SetLevels>(set_levels)(0);
}

}  // namespace

Eigen::MatrixXd SolveCholesky(const Eigen::SparseMatrix<double>& a, const Eigen::MatrixXd& b) {
  KeepOpenMpToCaller();
  Eigen::CholmodSupernodalLLT<Eigen::SparseMatrix<double>, Eigen::Lower> factor(a);
  Require(factor.info() == Eigen::Success, ErrorCode::kInternal, "the matrix is not positive definite");
  return factor.solve(b);
}

}  // namespace parkade
