#pragma once

#include <span>
#include <vector>

#include "mapping/ground/driven_path.h"
#include "mapping/ground/patch_source.h"
#include "mapping/heights/ground_squares.h"
#include "mapping/heights/height_field.h"
#include "mapping/heights/measure_heights_options.h"

namespace parkade {

/// Heights of the ground from many views of it: a plane sweep. Over each window of ground the
/// surface is lifted and lowered in steps; at each height all samples of all views move along their
/// viewing rays, and where the height is right, they agree: what remains of the variance of gray
/// values within small cells is least. Each view's mean in a window is taken off first, so that
/// exposures need not agree. A window whose ground shows too little is asked together with those
/// around it. R. Collins, "A space-sweep approach to true multi-image matching", CVPR 1996. \param
/// field       what is known so far; windows follow its slopes \param max_offset  [m] of the sweep
/// to each side \return at most one height per window, spread over its patches; none where the
/// ground shows nothing, the views do
///         not agree on one height, or the windows around do not support it.
/// \param only  of SweepSquares; null: everywhere
std::vector<HeightObservation> MeasureHeights(const PatchSource& patches,
                                              std::span<const DrivenPath> paths,
                                              const HeightField& field, double max_offset,
                                              const MeasureHeightsOptions& options,
                                              const GroundSquares* only = nullptr);

}  // namespace parkade
