#pragma once

#include "mapping/paint_lines.h"
#include "mapping/turned_ground.h"
#include "mapping/upright_lines.h"

namespace parkade {

/// Sets a line's ends to where its paint ends, its contrast and width to those of what lies between, and whether ground
/// without paint was seen behind either end. A line of which nothing is known stays.
void RefineLine(const TurnedGround& ground, const PaintLineOptions& options, UprightLine& line);

}  // namespace parkade
