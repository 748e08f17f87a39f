#pragma once

#include <span>
#include <vector>

#include "mapping/ground/driven_path.h"
#include "mapping/ground/patch_source.h"
#include "mapping/heights/sweep_agreement.h"
#include "mapping/kerbs/outline_strips.h"

namespace parkade {

/// [m] of a strip to the camera: a step is clear from near only.
inline constexpr double kMaxKerbDistance = 9.0;

/// Which strip along an outline is looked at, and at which heights.
struct StripWindow {
  static constexpr int kNearRows = 2, kFarRows = 3;
  static constexpr double kCellSize = 0.1;     ///< [m] of the image of a strip
  static constexpr double kHeightStep = 0.01;  ///< [m]

  double begin = 0;                         ///< [m] beyond the outline; negative: before it
  double min_height = 0, max_height = 0.1;  ///< [m] above the ground at the outline

  double End() const { return begin + kCellSize * (kNearRows + kFarRows); }  ///< [m]
  int NumHeights() const;
  double HeightAt(double step) const { return min_height + step * kHeightStep; }  ///< [m]
};

/// One strip at all heights of the sweep, from the lowest up: what is next to the outline and what
/// lies farther off. Of agreements, `total` is along the outline: each row's mean is taken off.
/// Empty where nothing was seen.
struct SweptStrip {
  std::vector<Agreement> near_outline = {}, far_off = {};
  int num_views = 0;
  double parallax = 0;  ///< [m per meter of height] rms by which views' shifts along it differ
};

/// Lifts strips from the plane of the ground at the outline. All samples count, whatever they were
/// taken for; they move along their viewing rays. What is the same all along the outline says
/// nothing: a car that passes a straight kerb sees the edge of its top at the same place of its
/// plane from everywhere. So variance is that along rows parallel to the outline, and each view's
/// mean is taken off at each height, so that exposures need not agree. Contrasts are bounded:
/// bright things that stand there would outvote the ground. The views of each drive are held
/// against each other alone, and what all drives say is summed up: other days have other shadows,
/// and drives lie centimeters off each other. \return for each window one for each
/// strip. In parallel, the same every time. Memory: what is seen of the strips in a square of 24 m.
std::vector<std::vector<SweptStrip>> SweepStrips(std::span<const OutlineStrip> strips,
                                                 double length, const PatchSource& patches,
                                                 std::span<const DrivenPath> paths,
                                                 std::span<const StripWindow> windows);

}  // namespace parkade
