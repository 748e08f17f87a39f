#pragma once

#include <ceres/problem.h>

#include <Eigen/Core>
#include <optional>
#include <unordered_set>
#include <vector>

namespace parkade {

/// Covariance of the blocks `of` (their tangents, in that order) of a solved least-squares problem.
///
/// Weights are not quite the noise's, hence the "sandwich" H^-1 M H^-1, M being the covariance of
/// the score J^T r: of a landmark what the sum of its own residuals shows, times kCommonErrors,
/// since they err alike; of all else J^T J; and what errors of an IMU's scale and axes add, which
/// nobody estimates (ScoreSensitivity). Landmarks are eliminated one by one (Schur), the rest is
/// one sparse factorization and as many solves as `of` has columns. P. J. Huber, "The behavior of
/// maximum likelihood estimates under nonstandard conditions", 1967.
///
/// \param landmarks  blocks of 3 that no residual shares; a residual that sees one has it as its
/// last parameter, and
///                   those of one landmark follow each other
/// \return nothing where the rest is not determined
std::optional<Eigen::MatrixXd> MarginalCovariance(
    const ceres::Problem& problem, const std::unordered_set<const double*>& landmarks,
    const std::vector<const double*>& of);

}  // namespace parkade
