#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "mapping/texture/chart_painter.h"

namespace parkade {

/// What stands in the way of images, by their indices.
struct ObstacleChecks {
  /// Whether the image may show a place; asked first, of some places.
  std::function<bool(std::size_t image, const Eigen::Vector2d& place)> may_show;
  /// Says what of the ground the image shows (open_ground); asked once of images that may be
  /// chosen.
  std::function<void(std::size_t image)> prepare;
};

/// Which images of many to read, so that what is read is in proportion to the ground and not to the
/// number of times that somebody drove over it: those that show some places clearly more steeply
/// than the images chosen so far, or about as steeply where fewer than four of them do. Images are
/// asked from the last to the first: where a later drive saw a place, an earlier one shows it only
/// if it saw it eight times as steeply. Decided by geometry alone, before anything is decoded.
/// O(images x places near them).
///
/// \param images   drive by drive, the latest last; their images are not looked at
/// \param places   [m] in site, on the ground, evenly spread
/// \param obstacles  nothing stands anywhere without
/// \return for each image whether it is chosen
std::vector<bool> ChooseImages(std::span<GroundImage> images,
                               std::span<const Eigen::Vector3d> places, double max_range,
                               const std::optional<ObstacleChecks>& obstacles = std::nullopt);

}  // namespace parkade
