#pragma once

#include <Eigen/Core>
#include <vector>

#include "mapping/ground_tiles.h"

namespace parkade {

struct PaintLineOptions {
  double pixel_size = 0.025;   ///< [m] at which lines are looked for
  double stripe_width = 0.12;  ///< [m] of the stripes that answer most
  double filter_length = 0.6;  ///< [m] along which brightness is averaged: more finds fainter, not shorter lines
  double min_contrast = 0.06;  ///< against both sides, of their brightness
  double min_length = 0.6;     ///< [m] of a line
  double max_gap = 0.6;        ///< [m] that a line may be interrupted
  int max_directions = 4;      ///< that one neighbourhood may have

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("pixel_size", pixel_size);
    visit("stripe_width", stripe_width);
    visit("filter_length", filter_length);
    visit("min_contrast", min_contrast);
    visit("min_length", min_length);
    visit("max_gap", max_gap);
    visit("max_directions", max_directions);
  }
  void Validate() const;  ///< throws Error{kUsage}
};

/// A straight bright stripe on the ground. Its ends are where the paint ends, or where the ground is no longer seen.
struct PaintLine {
  Eigen::Vector2d begin = Eigen::Vector2d::Zero(), end = Eigen::Vector2d::Zero();  ///< [m] in site, in the middle
  double height = 0;                                                               ///< [m] in site
  double width = 0;                                                                ///< [m]
  double contrast = 0;         ///< against the ground beside it, of that ground's brightness
  bool is_begin_seen = false;  ///< there is ground without paint beyond: the paint ends here
  bool is_end_seen = false;
  bool is_yellow = false;
  bool is_one_sided = false;  ///< most of it has not sure ground on both sides: an edge of something, maybe

  double Length() const { return (end - begin).norm(); }
  Eigen::Vector2d Direction() const { return (end - begin).normalized(); }
  Eigen::Vector2d Middle() const { return 0.5 * (begin + end); }
};

/// The lines whose middles lie in the core of a tile, of the directions that most of its edges have. Sub-pixel across;
/// along to a few centimetres.
///
/// For each direction the tile is turned so that lines stand upright; a matched filter (a stripe against both its
/// sides, averaged along it) answers, maxima across are linked along, a straight line is fitted to them, and its ends
/// are put where half the contrast is lost.
std::vector<PaintLine> FindPaintLines(const GroundTile& tile, const PaintLineOptions& options = {});

}  // namespace parkade
