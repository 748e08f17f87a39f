#include "slam/smoother/marginalizer.h"

#include <Eigen/QR>
#include <algorithm>
#include <optional>

#include "slam/factors/imu_sensitivity.h"
#include "slam/factors/measurement_model.h"

namespace parkade {

Marginalizer::Marginalizer(int num_dropped, int num_kept)
    : num_dropped_(num_dropped),
      num_kept_(num_kept),
      score_covariance_(Eigen::MatrixXd::Zero(num_dropped + num_kept, num_dropped + num_kept)),
      score_sensitivity_(Eigen::MatrixXd::Zero(num_dropped + num_kept, kImuSensitivities)) {}

void Marginalizer::AddSensitivity(const std::vector<int>& columns,
                                  const Eigen::MatrixXd& sensitivity) {
  for (size_t i = 0; i < columns.size(); ++i)
    score_sensitivity_.row(columns[i]) += sensitivity.row(static_cast<Eigen::Index>(i));
}

void Marginalizer::AddScores(const std::vector<int>& columns, const Eigen::MatrixXd& covariance) {
  for (size_t j = 0; j < columns.size(); ++j)
    for (size_t i = 0; i < columns.size(); ++i)
      score_covariance_(columns[i], columns[j]) +=
          covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
}

bool Marginalizer::Add(const LinearizableBlock& block, const Eigen::MatrixXd* score_covariance) {
  const std::optional<LinearizedBlock> evaluated = Linearize(block);
  if (!evaluated) return false;
  int width = 0;
  for (const int size : block.tangent_sizes) width += size;
  Rows rows{{}, Eigen::MatrixXd(evaluated->residual.size(), width + 1)};
  for (size_t i = 0, at = 0; i < evaluated->jacobians.size(); ++i) {
    const auto size = static_cast<size_t>(block.tangent_sizes[i]);
    rows.matrix.middleCols(static_cast<Eigen::Index>(at), block.tangent_sizes[i]) =
        evaluated->jacobians[i];
    for (int k = 0; k < block.tangent_sizes[i]; ++k) rows.columns.push_back(block.columns[i] + k);
    at += size;
  }
  rows.matrix.rightCols<1>() = evaluated->residual;
  const auto jacobian = rows.matrix.leftCols(width);
  AddScores(rows.columns, score_covariance ? *score_covariance : jacobian.transpose() * jacobian);
  rows_.push_back(std::move(rows));
  return true;
}

bool Marginalizer::AddLandmark(std::span<const LinearizableBlock> observations) {
  // Dense rows over the columns that this landmark touches, its own first.
  Rows rows;
  for (const LinearizableBlock& block : observations)
    for (size_t i = 0; i + 1 < block.columns.size(); ++i)
      for (int k = 0; k < block.tangent_sizes[i]; ++k) rows.columns.push_back(block.columns[i] + k);
  std::sort(rows.columns.begin(), rows.columns.end());
  rows.columns.erase(std::unique(rows.columns.begin(), rows.columns.end()), rows.columns.end());
  constexpr Eigen::Index kOwn = 3;
  const auto width = static_cast<Eigen::Index>(rows.columns.size());
  Eigen::MatrixXd stacked =
      Eigen::MatrixXd::Zero(2 * static_cast<Eigen::Index>(observations.size()), kOwn + width + 1);
  if (stacked.rows() <= kOwn) return false;
  Eigen::Index row = 0;
  for (const LinearizableBlock& block : observations) {
    const std::optional<LinearizedBlock> evaluated = Linearize(block);
    if (!evaluated) return false;
    stacked.block<2, kOwn>(row, 0) = evaluated->jacobians.back();
    for (size_t i = 0; i + 1 < block.columns.size(); ++i) {
      const auto found =
          std::lower_bound(rows.columns.begin(), rows.columns.end(), block.columns[i]);
      stacked.block(row, kOwn + (found - rows.columns.begin()), 2, block.tangent_sizes[i]) =
          evaluated->jacobians[i];
    }
    stacked.block<2, 1>(row, kOwn + width) = evaluated->residual;
    row += 2;
  }
  // Rotate the landmark's three columns into the first three rows and leave those.
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(stacked.leftCols(kOwn));
  stacked.applyOnTheLeft(qr.householderQ().adjoint());
  rows.matrix = stacked.bottomRightCorner(stacked.rows() - kOwn, width + 1);
  const Eigen::VectorXd score = rows.matrix.leftCols(width).transpose() * rows.matrix.col(width);
  AddScores(rows.columns, kCommonErrors * score * score.transpose());
  rows_.push_back(std::move(rows));
  return true;
}

Marginalizer::Result Marginalizer::Finish() const {
  const Eigen::Index width = num_dropped_ + num_kept_;
  Eigen::Index height = 0;
  for (const Rows& rows : rows_) height += rows.matrix.rows();
  Eigen::MatrixXd stacked = Eigen::MatrixXd::Zero(std::max(height, width + 1), width + 1);
  Eigen::Index row = 0;
  for (const Rows& rows : rows_) {
    for (size_t c = 0; c < rows.columns.size(); ++c)
      stacked.block(row, rows.columns[c], rows.matrix.rows(), 1) =
          rows.matrix.col(static_cast<Eigen::Index>(c));
    stacked.block(row, width, rows.matrix.rows(), 1) = rows.matrix.rightCols<1>();
    row += rows.matrix.rows();
  }
  const Eigen::HouseholderQR<Eigen::Ref<Eigen::MatrixXd>> qr(stacked);
  Result result;
  result.dropped_information =
      stacked.topLeftCorner(num_dropped_, num_dropped_).triangularView<Eigen::Upper>();
  result.dropped_to_kept = stacked.block(0, num_dropped_, num_dropped_, num_kept_);
  result.dropped_offset = stacked.block(0, width, num_dropped_, 1);
  result.sqrt_information = stacked.block(num_dropped_, num_dropped_, num_kept_, num_kept_)
                                .triangularView<Eigen::Upper>();
  result.offset = stacked.block(num_dropped_, width, num_kept_, 1);
  result.scores = EliminateScores(score_covariance_, score_sensitivity_, result.dropped_information,
                                  result.dropped_to_kept);
  return result;
}

}  // namespace parkade
