#pragma once

#include "mapping/markings/paint_line_options.h"
#include "mapping/markings/rotated_raster.h"
#include "mapping/markings/upright_line.h"

namespace parkade {

/// Sets a line's ends to where its paint ends, its contrast and width to those of what lies
/// between, and whether ground without paint was seen behind either end. A line of which nothing is
/// known stays.
void RefineLine(const RotatedRaster& ground, const PaintLineOptions& options,
                AxisAlignedLine& line);

}  // namespace parkade
