#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "slam/factors/linear_prior.h"
#include "slam/factors/linearize_block.h"

namespace parkade {

/// Turns residual blocks into a prior on the columns that stay, by Householder
/// QR of the stacked Jacobian: never squares it as a Hessian would.
/// N. Demmel et al., "Square Root Marginalization for Sliding-Window Bundle
/// Adjustment", ICCV 2021.
class Marginalizer {
 public:
  /// A system of `num_dropped` + `num_kept` columns, the dropped ones first.
  Marginalizer(int num_dropped, int num_kept);

  /// Returns false, adding nothing, when the block cannot be evaluated.
  /// `score_covariance`, of the block's tangents, where it is not the information.
  bool Add(const LinearizableBlock& block, const Eigen::MatrixXd* score_covariance = nullptr);

  /// By what is considered but not estimated: rows as `columns` of the system.
  void AddSensitivity(const std::vector<int>& columns, const Eigen::MatrixXd& sensitivity);

  /// All observations of one landmark, whose three parameters are the last block
  /// of each (its column is ignored): eliminated at once. A track's errors last from image to
  /// image; what they add up to is read off its residuals, taken as one draw, times kCommonErrors:
  /// K.-Y. Liang, S. L. Zeger, "Longitudinal data analysis using generalized linear models",
  /// Biometrika 1986.
  bool AddLandmark(std::span<const LinearizableBlock> observations);

  struct Result {
    Eigen::MatrixXd
        dropped_information;  ///< of the dropped columns given the kept ones, upper triangular
    Eigen::MatrixXd dropped_to_kept;  ///< num_dropped x num_kept
    Eigen::VectorXd dropped_offset;
    Eigen::MatrixXd sqrt_information;  ///< rows <= num_kept, upper triangular
    Eigen::VectorXd offset;
    ScoreElimination scores;
  };
  /// What the blocks say about the kept columns, and about the dropped ones given those.
  Result Finish() const;

 private:
  struct Rows {
    std::vector<int> columns;  ///< of the system, one per column of `matrix` but the last
    Eigen::MatrixXd matrix;    ///< Jacobian | residual
  };

  void AddScores(const std::vector<int>& columns, const Eigen::MatrixXd& covariance);

  int num_dropped_;
  int num_kept_;
  std::vector<Rows> rows_;
  Eigen::MatrixXd score_covariance_, score_sensitivity_;
};

}  // namespace parkade
