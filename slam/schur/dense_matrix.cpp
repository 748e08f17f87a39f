#include <algorithm>
#include <vector>

#include "slam/schur/envelope_matrix.h"
#include "slam/schur/reduced_matrix.h"

namespace parkade {
namespace {

/// The first column of a state that something ties to the row's, by row.
std::vector<int> FirstColumns(const SchurStructure& structure) {
  std::vector<int> of_states;
  of_states.reserve(structure.states.size());
  for (const SchurState& state : structure.states) of_states.push_back(state.column);
  for (const SchurChunk& chunk : structure.chunks)
    for (const SchurPair& pair : chunk.pairs) {
      int& first = of_states[static_cast<size_t>(chunk.states[pair.row])];
      first =
          std::min(first, structure.states[static_cast<size_t>(chunk.states[pair.column])].column);
    }
  std::vector<int> of_rows;
  for (size_t i = 0; i < of_states.size(); ++i)
    of_rows.insert(of_rows.end(), static_cast<size_t>(structure.states[i].tangent_size),
                   of_states[i]);
  return of_rows;
}

class DenseMatrix final : public ReducedMatrix {
 public:
  explicit DenseMatrix(const SchurStructure& structure)
      : structure_(structure), matrix_(FirstColumns(structure)) {}

  void SetZero() override { matrix_.SetZero(); }

  void Add(size_t chunk, const SchurSums& sums) override {
    const SchurChunk& of = structure_.chunks[chunk];
    for (const SchurPair& pair : of.pairs) {
      const SchurState& row = structure_.states[static_cast<size_t>(of.states[pair.row])];
      const SchurState& column = structure_.states[static_cast<size_t>(of.states[pair.column])];
      for (int r = 0; r < row.tangent_size; ++r) {
        const double* from = &sums.matrix(of.columns[pair.row] + r, of.columns[pair.column]);
        double* to = matrix_.Row(row.column + r) + column.column;
        const int count = pair.row == pair.column ? r + 1 : column.tangent_size;
        for (int c = 0; c < count; ++c) to[c] += from[c];
      }
    }
  }

  std::optional<Eigen::VectorXd> Solve(const Eigen::VectorXd& damping,
                                       const Eigen::VectorXd& right) override {
    for (int i = 0; i < matrix_.size(); ++i) matrix_.Row(i)[i] += damping[i];
    return matrix_.Solve(right);
  }

 private:
  const SchurStructure& structure_;
  EnvelopeMatrix matrix_;
};

}  // namespace

std::unique_ptr<ReducedMatrix> MakeDenseMatrix(const SchurStructure& structure) {
  return std::make_unique<DenseMatrix>(structure);
}

}  // namespace parkade
