#include <Eigen/Sparse>
#include <algorithm>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/math/sparse_cholesky.h"
#include "slam/schur/reduced_matrix.h"

namespace parkade {
namespace {

using Index = Eigen::Index;

/// The states below each on the diagonal and itself that something ties to it, ascending.
std::vector<std::vector<int>> TiedStates(const SchurStructure& structure) {
  std::vector<std::vector<int>> tied(structure.states.size());
  for (size_t i = 0; i < tied.size(); ++i) tied[i].push_back(static_cast<int>(i));
  for (const SchurChunk& chunk : structure.chunks)
    for (const SchurPair& pair : chunk.pairs)
      tied[static_cast<size_t>(chunk.states[pair.column])].push_back(chunk.states[pair.row]);
  for (std::vector<int>& rows : tied) {
    std::sort(rows.begin(), rows.end());
    rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
  }
  return tied;
}

/// Lower triangle, with whole blocks on the diagonal.
class SparseMatrix final : public ReducedMatrix {
 public:
  explicit SparseMatrix(const SchurStructure& structure);
  void SetZero() override;
  void Add(size_t chunk, const SchurSums& sums) override;
  std::optional<Eigen::VectorXd> Solve(const Eigen::VectorXd& damping,
                                       const Eigen::VectorXd& right) override;

 private:
  const SchurStructure& structure_;
  Eigen::SparseMatrix<double> matrix_;
  std::vector<std::vector<Index>> offsets_;  ///< into its values: of blocks, by chunk and pair
  CholeskySolver solver_;
};

SparseMatrix::SparseMatrix(const SchurStructure& structure)
    : structure_(structure), matrix_(structure.num_columns, structure.num_columns) {
  const std::vector<std::vector<int>> tied = TiedStates(structure);
  std::vector<int> heights(static_cast<size_t>(structure.num_columns));
  std::vector<std::vector<Index>> first_rows(tied.size());  // of each block within a column
  for (size_t i = 0; i < tied.size(); ++i) {
    Index height = 0;
    for (const int row : tied[i]) {
      first_rows[i].push_back(height);
      height += structure.states[static_cast<size_t>(row)].tangent_size;
    }
    const SchurState& state = structure.states[i];
    std::fill_n(heights.begin() + state.column, state.tangent_size, static_cast<int>(height));
  }
  matrix_.reserve(heights);
  for (size_t i = 0; i < tied.size(); ++i)
    for (int k = 0; k < structure.states[i].tangent_size; ++k)
      for (const int row : tied[i]) {
        const SchurState& state = structure.states[static_cast<size_t>(row)];
        for (int r = 0; r < state.tangent_size; ++r)
          matrix_.insert(state.column + r, structure.states[i].column + k) = 0;
      }
  matrix_.makeCompressed();
  for (const SchurChunk& chunk : structure.chunks) {
    std::vector<Index>& offsets = offsets_.emplace_back();
    for (const SchurPair& pair : chunk.pairs) {
      const auto column = static_cast<size_t>(chunk.states[pair.column]);
      const auto place = static_cast<size_t>(
          std::lower_bound(tied[column].begin(), tied[column].end(), chunk.states[pair.row]) -
          tied[column].begin());
      offsets.push_back(matrix_.outerIndexPtr()[structure.states[column].column] +
                        first_rows[column][place]);
    }
  }
  SetZero();
}

void SparseMatrix::SetZero() { std::fill_n(matrix_.valuePtr(), matrix_.nonZeros(), 0.0); }

void SparseMatrix::Add(size_t chunk, const SchurSums& sums) {
  const SchurChunk& of = structure_.chunks[chunk];
  for (size_t i = 0; i < of.pairs.size(); ++i) {
    const SchurState& row = structure_.states[static_cast<size_t>(of.states[of.pairs[i].row])];
    const SchurState& column =
        structure_.states[static_cast<size_t>(of.states[of.pairs[i].column])];
    const Index stride =
        matrix_.outerIndexPtr()[column.column + 1] - matrix_.outerIndexPtr()[column.column];
    double* to = matrix_.valuePtr() + offsets_[chunk][i];
    const double* from = sums.matrix.data() + of.columns[of.pairs[i].row] * sums.matrix.cols() +
                         of.columns[of.pairs[i].column];
    for (int c = 0; c < column.tangent_size; ++c)
      for (int r = 0; r < row.tangent_size; ++r)
        to[c * stride + r] += from[r * sums.matrix.cols() + c];
  }
}

std::optional<Eigen::VectorXd> SparseMatrix::Solve(const Eigen::VectorXd& damping,
                                                   const Eigen::VectorXd& right) {
  // The diagonal block is the first of each column.
  for (const SchurState& state : structure_.states)
    for (int k = 0; k < state.tangent_size; ++k)
      matrix_.valuePtr()[matrix_.outerIndexPtr()[state.column + k] + k] +=
          damping[state.column + k];
  try {
    Eigen::VectorXd x = solver_.SolveSimilar(matrix_, right);
    return x.allFinite() ? std::optional(std::move(x)) : std::nullopt;
  } catch (const Error&) {
    return std::nullopt;
  }
}

}  // namespace

std::unique_ptr<ReducedMatrix> MakeSparseMatrix(const SchurStructure& structure) {
  return std::make_unique<SparseMatrix>(structure);
}

}  // namespace parkade
