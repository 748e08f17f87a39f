#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "core/ground_texture.h"
#include "core/triangle_mesh.h"

namespace parkade {

/// A chart to be painted, with the heights of its texels.
struct BlankChart {
  TextureChart chart;  ///< `image` black
  cv::Mat height;      ///< CV_32FC1 [m] in site, at the texels' centers; NaN off the mesh
};

/// A square of ground and the triangles whose centers lie in it.
struct ChartSquare {
  int column = 0, row = 0;
  std::vector<std::uint32_t> triangles;  ///< increasing
};

/// The squares of `chart_size` [m] that hold triangles, by row, then column.
std::vector<ChartSquare> CutIntoSquares(const TriangleMesh& mesh, double chart_size);

/// Charts that show the triangles of a square from above without folds: one; where decks lie above
/// each other one for each connected piece; where a piece (a spiral ramp) lies above itself one for
/// each band of height.
std::vector<BlankChart> ChartsOf(const ChartSquare& square, const TriangleMesh& mesh,
                                 double texel_size);

}  // namespace parkade
