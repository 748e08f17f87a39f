#include "slam/schur/reduced_system.h"

namespace parkade {
namespace {

constexpr int kDenseColumns = 384;  // of a window with a few cameras

}  // namespace

std::unique_ptr<ReducedMatrix> MakeReducedMatrix(const SchurStructure& structure) {
  return structure.num_columns <= kDenseColumns ? MakeDenseMatrix(structure)
                                                : MakeSparseMatrix(structure);
}

ReducedSystem::ReducedSystem(const SchurStructure& structure)
    : structure_(structure), matrix_(MakeReducedMatrix(structure)) {
  SetZero();
}

void ReducedSystem::SetZero() {
  matrix_->SetZero();
  gradient_.setZero(structure_.num_columns);
  right_.setZero(structure_.num_columns);
  squared_norms_.setZero(structure_.num_columns);
}

void ReducedSystem::Add(size_t chunk, const SchurSums& sums) {
  matrix_->Add(chunk, sums);
  const SchurChunk& of = structure_.chunks[chunk];
  for (size_t i = 0; i < of.states.size(); ++i) {
    const SchurState& state = structure_.states[static_cast<size_t>(of.states[i])];
    const auto add = [&](const Eigen::VectorXd& part, Eigen::VectorXd& whole) {
      whole.segment(state.column, state.tangent_size) +=
          part.segment(of.columns[i], state.tangent_size);
    };
    add(sums.gradient, gradient_);
    add(sums.right, right_);
    add(sums.squared_norms, squared_norms_);
  }
}

std::optional<Eigen::VectorXd> ReducedSystem::Solve(const Eigen::VectorXd& damping) {
  std::optional<Eigen::VectorXd> x = matrix_->Solve(damping, right_);
  return x && x->allFinite() ? x : std::nullopt;
}

}  // namespace parkade
