#pragma once

#include <Eigen/Core>
#include <vector>

#include "mapping/markings/ground_tiles.h"
#include "mapping/markings/paint_line_options.h"

namespace parkade {

/// A straight bright stripe on the ground. Its ends are where the paint ends, or where the ground
/// is no longer seen.
struct PaintLine {
  Eigen::Vector2d begin = Eigen::Vector2d::Zero(),
                  end = Eigen::Vector2d::Zero();  ///< [m] in site, in the middle
  double height = 0;                              ///< [m] in site
  double width = 0;                               ///< [m]
  double contrast = 0;         ///< against the ground beside it, of that ground's brightness
  bool is_begin_seen = false;  ///< there is ground without paint beyond: the paint ends here
  bool is_end_seen = false;
  bool is_yellow = false;
  bool is_one_sided =
      false;  ///< most of it has not sure ground on both sides: an edge of something, maybe

  double Length() const { return (end - begin).norm(); }
  Eigen::Vector2d Direction() const { return (end - begin).normalized(); }
  Eigen::Vector2d Middle() const { return 0.5 * (begin + end); }
};

/// The lines whose middles lie in the core of a tile, of the directions that most of its edges
/// have. Sub-pixel across; along to a few centimeters.
///
/// For each direction the tile is turned so that lines stand upright; a matched filter (a stripe
/// against both its sides, averaged along it) answers, maxima across are linked along, a straight
/// line is fitted to them, and its ends are put where half the contrast is lost.
std::vector<PaintLine> FindPaintLines(const GroundTile& tile, const PaintLineOptions& options = {});

}  // namespace parkade
