#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/rigid3.h"

namespace parkade {

/// target = scale * rotation * source + translation.
struct SimilarityAlignment {
  Rigid3 target_from_source;  ///< best rigid motion, scale 1
  double scale = 1;           ///< best scale of the source, when it is free too
};

/// Least squares over corresponding columns (3 x N, [m], N >= 1). S. Umeyama,
/// TPAMI 1991, eq. 40-42. Where the points do not fix the rotation (one point, a
/// line) the part that is not fixed stays as small as the decomposition gives it.
SimilarityAlignment AlignPoints(const Eigen::Matrix3Xd& source, const Eigen::Matrix3Xd& target);

/// Rotation about z and translation only, with weights per column for the
/// horizontal part and for the vertical part. Closed form.
Rigid3 AlignYawAndTranslation(const Eigen::Matrix3Xd& source, const Eigen::Matrix3Xd& target,
                              const Eigen::VectorXd& horizontal_weights,
                              const Eigen::VectorXd& vertical_weights);

}  // namespace parkade
