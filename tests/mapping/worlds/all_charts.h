#pragma once

#include <vector>

#include "mapping/texture/texture_charts.h"

namespace parkade {

/// All charts of a mesh, sorted as GroundTexture says.
inline std::vector<BlankChart> CutIntoCharts(const TriangleMesh& mesh, double chart_size,
                                             double texel_size) {
  std::vector<BlankChart> charts;
  for (const ChartSquare& square : CutIntoSquares(mesh, chart_size))
    for (BlankChart& chart : ChartsOf(square, mesh, texel_size)) charts.push_back(std::move(chart));
  return charts;
}

}  // namespace parkade
