#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "slam/linear_prior.h"

namespace parkade {

struct FinishedKnot;

/// What a knot was, given the states that stayed when it left the window: the
/// rows that marginalisation in square-root form sets aside,
///   own d + to_rest (rest [-] at) + offset = 0,   d: from the knot's values then.
/// Single precision: corrections are small.
struct KnotConditional {
  Eigen::MatrixXf own;      ///< 15 x 15, upper triangular; [rotation, position, v, b_g, b_a]
  Eigen::MatrixXf to_rest;  ///< 15 x n
  Eigen::VectorXf offset;   ///< 15
  std::vector<PriorBlock> rest;
};

/// Corrects all knots of a drive by what was learned after they left the window,
/// from the last to the first: the linear smoother of the whole drive, without
/// solving it. A car learns on its first turn how it was tilted before.
///
/// H. E. Rauch, F. Tung, C. T. Striebel, "Maximum likelihood estimates of linear
/// dynamic systems", AIAA Journal 1965, here as back-substitution of the QR.
/// `knots` are all that left the window, in order; the last is taken as it is,
/// with `last_covariance` of [pose, motion, wheel scale], 16 x 16. Sets the
/// covariances, too. Linear in the drive's length.
void SmoothBackwards(std::vector<FinishedKnot>& knots, double wheel_scale, const Eigen::MatrixXd& last_covariance);

}  // namespace parkade
