#pragma once

#include <ceres/loss_function.h>

namespace parkade {

/// Variance of what a track's errors add up to / what its residuals show of it: a patch slides
/// along the flow as it grows, and tracks that live side by side slide alike, so that residuals are
/// the smaller part. From drives with known truth, see docs/decisions/.
inline constexpr double kCommonErrors = 6;

/// The loss of a bearing [sigma]: robust, and worth as much beside the IMU, wheels and the rig as
/// errors that last leave of it.
inline ceres::ScaledLoss BearingLoss(double robust_width) {
  return {new ceres::CauchyLoss(robust_width), 1 / kCommonErrors, ceres::TAKE_OWNERSHIP};
}

}  // namespace parkade
