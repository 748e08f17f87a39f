#pragma once

#include <span>
#include <vector>

#include "mapping/ground/driven_path.h"
#include "mapping/ground/patch_source.h"
#include "mapping/heights/ground_squares.h"
#include "mapping/heights/height_field.h"
#include "mapping/heights/measure_heights_options.h"

namespace parkade {

/// Heights of the ground patch by patch of a field, as MeasureHeights finds those of larger
/// windows, but with steps: kerbs, islands, the floor beside a ramp. What the views of a window say
/// of each height is a likelihood of the variance that remains there; windows around it have a say
/// by SumAlongScanlines. Windows are those of the field's squares. All samples count that show
/// ground, drivable or not. Edges that run along the path look alike at every height: they may be
/// sure of a wrong one. \return one height per window, the mean and the deviation of its
/// likelihood; none where that
///         exceeds 6 cm, or two windows around do not agree
/// \param only  of SweepSquares; null: everywhere
std::vector<HeightObservation> MeasureFineHeights(const PatchSource& patches,
                                                  std::span<const DrivenPath> paths,
                                                  const HeightField& field,
                                                  const MeasureHeightsOptions& options,
                                                  const GroundSquares* only = nullptr);

}  // namespace parkade
