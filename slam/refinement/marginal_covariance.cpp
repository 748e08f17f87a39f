#include "slam/refinement/marginal_covariance.h"

#include <Eigen/Cholesky>
#include <Eigen/Sparse>
#include <algorithm>
#include <cstdint>
#include <unordered_map>

#include "core/error.h"
#include "core/math/sparse_cholesky.h"
#include "core/tune_malloc.h"
#include "slam/factors/imu_sensitivity.h"
#include "slam/factors/landmark_parameters.h"
#include "slam/factors/linearize_block.h"
#include "slam/factors/measurement_model.h"

namespace parkade {
namespace {

constexpr int kConstant = -1;  // column of what does not move

/// Free unknowns that one landmark, or one other residual, ties together.
struct Block {
  int column = 0, size = 0;
  auto operator<=>(const Block&) const = default;
};

/// A sparse matrix that is written row by row.
class SparseRows {
 public:
  void Add(int column, double value) {
    if (value == 0) return;
    columns_.push_back(column);
    values_.push_back(value);
  }
  void EndRow() { begins_.push_back(static_cast<int>(columns_.size())); }

  Eigen::Map<const Eigen::SparseMatrix<double, Eigen::RowMajor>> Matrix(int num_columns) const {
    return {static_cast<Eigen::Index>(begins_.size()) - 1,
            num_columns,
            static_cast<Eigen::Index>(values_.size()),
            begins_.data(),
            columns_.data(),
            values_.data()};
  }

 private:
  std::vector<int> columns_;
  std::vector<double> values_;
  std::vector<int> begins_ = {0};
};

/// Information and score of all unknowns but landmarks.
class NormalEquations {
 public:
  NormalEquations(const ceres::Problem& problem,
                  const std::unordered_set<const double*>& landmarks) {
    std::vector<double*> blocks;
    problem.GetParameterBlocks(&blocks);
    for (double* block : blocks) {
      if (landmarks.contains(block)) continue;
      const bool is_constant = problem.IsParameterBlockConstant(block);
      const Block columns{is_constant ? kConstant : num_columns_,
                          problem.ParameterBlockTangentSize(block)};
      columns_.emplace(block, columns);
      if (!is_constant) num_columns_ += columns.size;
    }
    sensitivity_ = Eigen::MatrixXd::Zero(num_columns_, kImuSensitivities);
    std::vector<ceres::ResidualBlockId> residuals;
    problem.GetResidualBlocks(&residuals);
    const double* landmark = nullptr;
    std::vector<LinearizableBlock> observations;
    for (const ceres::ResidualBlockId id : residuals) {
      LinearizableBlock block = BlockOf(problem, id);
      const double* last = block.parameters.back();
      if (!landmarks.contains(last)) {
        Add(block);
        continue;
      }
      if (last != landmark) AddLandmark(observations);
      landmark = last;
      observations.push_back(std::move(block));
    }
    AddLandmark(observations);
  }

  /// Once: what takes most memory is let go of.
  Eigen::SparseMatrix<double> TakeInformation() {
    std::vector<std::pair<int, int>> places;  // column, row
    std::vector<int> heights(static_cast<size_t>(num_columns_));
    for (const auto& [key, block] : information_) {
      const auto& [column, row] =
          places.emplace_back(static_cast<int>(key & 0xffffffff), static_cast<int>(key >> 32));
      for (int j = 0; j < block.cols(); ++j)
        heights[static_cast<size_t>(column + j)] +=
            static_cast<int>(block.rows()) - (row == column ? j : 0);
    }
    std::sort(places.begin(), places.end());
    Eigen::SparseMatrix<double> matrix(num_columns_, num_columns_);
    matrix.reserve(heights);
    for (const auto& [column, row] : places) {
      const Eigen::MatrixXd& block = information_.at(KeyOf(row, column));
      for (int j = 0; j < block.cols(); ++j)
        for (int i = row == column ? j : 0; i < block.rows(); ++i)
          matrix.insert(row + i, column + j) = block(i, j);
    }
    matrix.makeCompressed();
    information_.clear();
    return matrix;
  }

  /// R with R^T R = covariance of the score; borrowed.
  auto Scores() const { return scores_.Matrix(num_columns_); }

  /// Derivative of the score by what is considered but not estimated.
  const Eigen::MatrixXd& sensitivity() const { return sensitivity_; }

  const Block& ColumnsOf(const double* block) const { return columns_.at(block); }

 private:
  static std::uint64_t KeyOf(int row, int column) {
    return static_cast<std::uint64_t>(row) << 32 | static_cast<std::uint32_t>(column);
  }

  LinearizableBlock BlockOf(const ceres::Problem& problem, ceres::ResidualBlockId id) const {
    LinearizableBlock block;
    block.cost = problem.GetCostFunctionForResidualBlock(id);
    block.loss = problem.GetLossFunctionForResidualBlock(id);
    std::vector<double*> parameters;
    problem.GetParameterBlocksForResidualBlock(id, &parameters);
    for (const double* parameter : parameters) {
      const auto columns = columns_.find(parameter);
      const bool is_landmark = columns == columns_.end();
      block.parameters.push_back(parameter);
      block.columns.push_back(is_landmark ? kConstant : columns->second.column);
      block.tangent_sizes.push_back(is_landmark ? kLandmarkSize : columns->second.size);
    }
    return block;
  }

  void AddInformation(const Block& row, const Block& column, const Eigen::MatrixXd& block) {
    const auto [entry, is_new] = information_.try_emplace(KeyOf(row.column, column.column), block);
    if (!is_new) entry->second += block;
  }

  void Add(const LinearizableBlock& block) {
    const std::optional<LinearizedBlock> linear = Linearize(block);
    if (!linear) return;
    for (Eigen::Index row = 0; row < linear->residual.size(); ++row) {
      for (size_t i = 0; i < block.columns.size(); ++i) {
        if (block.columns[i] == kConstant) continue;
        const LinearizedBlock::Jacobian& by_i = linear->jacobians[i];
        for (Eigen::Index k = 0; k < by_i.cols(); ++k)
          scores_.Add(block.columns[i] + static_cast<int>(k), by_i(row, k));
      }
      scores_.EndRow();
    }
    for (size_t i = 0; i < block.columns.size(); ++i) {
      if (block.columns[i] == kConstant) continue;
      const LinearizedBlock::Jacobian& by_i = linear->jacobians[i];
      for (size_t j = 0; j < block.columns.size(); ++j)
        if (block.columns[j] != kConstant && block.columns[j] <= block.columns[i])
          AddInformation({block.columns[i], block.tangent_sizes[i]},
                         {block.columns[j], block.tangent_sizes[j]},
                         by_i.transpose() * linear->jacobians[j]);
    }
    if (const auto* imu = dynamic_cast<const ImuCost*>(block.cost)) AddSensitivity(*imu, block);
  }

  void AddSensitivity(const ImuCost& imu, const LinearizableBlock& block) {
    const Eigen::MatrixXd of_block = ScoreSensitivity(imu, imu.preintegration(), block.parameters);
    Eigen::Index row = 0;
    for (size_t i = 0; i < block.columns.size(); row += block.tangent_sizes[i++])
      if (block.columns[i] != kConstant)
        sensitivity_.middleRows(block.columns[i], block.tangent_sizes[i]) +=
            of_block.middleRows(row, block.tangent_sizes[i]);
  }

  /// All observations of one landmark; empties them.
  void AddLandmark(std::vector<LinearizableBlock>& observations) {
    std::vector<Block> blocks;
    for (const LinearizableBlock& observation : observations)
      for (size_t i = 0; i < observation.columns.size(); ++i)
        if (observation.columns[i] != kConstant)
          blocks.push_back({observation.columns[i], observation.tangent_sizes[i]});
    std::sort(blocks.begin(), blocks.end());
    blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
    std::vector<int> first(blocks.size() + 1);  // among this landmark's columns
    for (size_t i = 0; i < blocks.size(); ++i) first[i + 1] = first[i] + blocks[i].size;

    Eigen::Matrix3d own = Eigen::Matrix3d::Zero();
    Eigen::Vector3d own_score = Eigen::Vector3d::Zero();
    Eigen::MatrixXd to_own = Eigen::MatrixXd::Zero(first.back(), kLandmarkSize);
    Eigen::VectorXd score = Eigen::VectorXd::Zero(first.back());
    for (const LinearizableBlock& observation : observations) {
      const std::optional<LinearizedBlock> linear = Linearize(observation);
      if (!linear) continue;
      const LinearizedBlock::Jacobian& by_landmark = linear->jacobians.back();
      own.noalias() += by_landmark.transpose() * by_landmark;
      own_score.noalias() += by_landmark.transpose() * linear->residual;
      for (size_t i = 0; i + 1 < observation.columns.size(); ++i) {
        if (observation.columns[i] == kConstant) continue;
        const LinearizedBlock::Jacobian& by_i = linear->jacobians[i];
        const Block block{observation.columns[i], observation.tangent_sizes[i]};
        const auto at = first[static_cast<size_t>(
            std::lower_bound(blocks.begin(), blocks.end(), block) - blocks.begin())];
        to_own.middleRows(at, block.size).noalias() += by_i.transpose() * by_landmark;
        score.segment(at, block.size).noalias() += by_i.transpose() * linear->residual;
        for (size_t j = 0; j + 1 < observation.columns.size(); ++j)
          if (observation.columns[j] != kConstant &&
              observation.columns[j] <= observation.columns[i])
            AddInformation(block, {observation.columns[j], observation.tangent_sizes[j]},
                           by_i.transpose() * linear->jacobians[j]);
      }
    }
    observations.clear();
    const Eigen::LLT<Eigen::Matrix3d> factor(own);
    if (blocks.empty() || factor.info() != Eigen::Success) return;
    score -= to_own * factor.solve(own_score);
    const Eigen::MatrixXd root = factor.matrixL().solve(to_own.transpose()).transpose();
    for (size_t i = 0; i < blocks.size(); ++i)
      for (size_t j = 0; j <= i; ++j)
        AddInformation(blocks[i], blocks[j],
                       -root.middleRows(first[i], blocks[i].size) *
                           root.middleRows(first[j], blocks[j].size).transpose());
    for (size_t i = 0; i < blocks.size(); ++i)
      for (int k = 0; k < blocks[i].size; ++k)
        scores_.Add(blocks[i].column + k, std::sqrt(kCommonErrors) * score[first[i] + k]);
    scores_.EndRow();
  }

  std::unordered_map<const double*, Block> columns_;
  std::unordered_map<std::uint64_t, Eigen::MatrixXd>
      information_;  ///< lower triangle, by row and column
  SparseRows scores_;
  Eigen::MatrixXd sensitivity_;
  int num_columns_ = 0;
};

}  // namespace

std::optional<Eigen::MatrixXd> MarginalCovariance(
    const ceres::Problem& problem, const std::unordered_set<const double*>& landmarks,
    const std::vector<const double*>& of) {
  NormalEquations normal(problem, landmarks);
  std::vector<int> columns;
  for (const double* block : of)
    for (int k = 0; k < normal.ColumnsOf(block).size; ++k)
      columns.push_back(normal.ColumnsOf(block).column + k);
  const auto count = static_cast<Eigen::Index>(columns.size());
  Eigen::MatrixXd by_score;
  try {
    const Eigen::SparseMatrix<double> information = normal.TakeInformation();
    ReleaseIdleMemory();  // what summing up took, before the factor takes more
    by_score = CholeskySolver().InverseColumns(information, columns);
  } catch (const Error&) {
    return std::nullopt;
  }

  constexpr Eigen::Index kRows = 512;  // of scores at a time
  const auto scores = normal.Scores();
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(count, count);
  covariance.selfadjointView<Eigen::Lower>().rankUpdate(by_score.transpose() *
                                                        normal.sensitivity());
  for (Eigen::Index row = 0; row < scores.rows(); row += kRows) {
    const Eigen::MatrixXd part =
        scores.middleRows(row, std::min(kRows, scores.rows() - row)) * by_score;
    covariance.selfadjointView<Eigen::Lower>().rankUpdate(part.transpose());
  }
  if (!covariance.allFinite()) return std::nullopt;
  return covariance.selfadjointView<Eigen::Lower>();
}

}  // namespace parkade
