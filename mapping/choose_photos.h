#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "mapping/chart_painter.h"

namespace parkade {

/// Which photos of many to read, so that what is read is in proportion to the ground and not to the number of times
/// that somebody drove over it: those that show some places clearly more steeply than the photos chosen so far, or
/// about as steeply where fewer than four of them do. Photos are asked from the last to the first: of days that saw a
/// place alike the latest shows it. Decided by geometry alone, before anything is decoded. \param photos  their images
/// are not looked at \param places  [m] in site, on the ground, evenly spread \return for each photo whether it is
/// chosen. O(photos x places near them).
std::vector<bool> ChoosePhotos(std::span<const GroundPhoto> photos, std::span<const Eigen::Vector3d> places,
                               double max_range);

}  // namespace parkade
