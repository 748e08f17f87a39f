#pragma once

#include <vector>

#include "slam/places/ray_point_correspondence.h"

namespace parkade {

/// Moves `a_from_b` to where the correspondences agree best: Gauss-Newton with Cauchy weights.
/// Returns the Hessian of the last step, by [translation | turn] on the right of the pose.
///
/// \param tilt_sigma  [rad] both keyframes are level, up to this; 0: nothing is known of gravity
Matrix6d AdjustToCorrespondences(const std::vector<RayPointCorrespondence>& correspondences,
                                 double tilt_sigma, Rigid3& a_from_b);

/// Covariance of a pose that was adjusted to these correspondences: hessian^-1 scaled by what the
/// residuals show, plus the effect of errors of the cameras' mounts (sigmas in the options). Those
/// are considered, not estimated (S. Schmidt, "Application of state-space methods to navigation
/// problems", 1966): with a residual's derivative G by the mounts, of variance Q, it is hessian^-1
/// (J^T W G) Q (J^T W G)^T hessian^-1. They cancel where the same camera sees the place twice in
/// the same direction, and add up where the car stands the other way around.
Matrix6d CovarianceOfCorrespondences(const std::vector<RayPointCorrespondence>& correspondences,
                                     const Matrix6d& hessian, const Rigid3& a_from_b,
                                     const RelativePoseOptions& options);

/// Sets information and worst_sigma from the covariance of what was seen, plus a floor below which
/// no loop is believed.
void SetInformation(const Matrix6d& covariance_of_correspondences, RelativePose& pose);

}  // namespace parkade
