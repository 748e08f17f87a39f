#pragma once

#include <vector>

#include "mapping/markings/paint_line_options.h"
#include "mapping/markings/rotated_raster.h"
#include "mapping/markings/upright_line.h"

namespace parkade {

/// [m] What is shorter is no line.
inline constexpr double kMinLineLength = 0.6;

/// Bright stripes that stand upright to a few degrees. O(pixels).
std::vector<AxisAlignedLine> FindAxisAlignedLines(const RotatedRaster& ground,
                                                  const PaintLineOptions& options);

}  // namespace parkade
