#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>
#include <vector>

#include "mapping/texture/chart_painter.h"

namespace parkade {

/// Which photos of many to read, so that what is read is in proportion to the ground and not to the number of times
/// that somebody drove over it: those that show some places clearly more steeply than the photos chosen so far, or
/// about as steeply where fewer than four of them do. Photos are asked from the last to the first: where a later drive
/// saw a place, an earlier one shows it only if it saw it eight times as steeply. Decided by geometry alone, before
/// anything is decoded. O(photos x places near them).
///
/// \param photos   drive by drive, the latest last; their images are not looked at
/// \param places   [m] in site, on the ground, evenly spread
/// \param prepare  is called once with each photo that may be chosen: says what of the ground it shows (open_ground)
/// \return for each photo whether it is chosen
std::vector<bool> ChoosePhotos(std::span<GroundPhoto> photos, std::span<const Eigen::Vector3d> places, double max_range,
                               const std::function<void(GroundPhoto&)>& prepare = {});

}  // namespace parkade
