#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "core/ground_texture.h"
#include "core/triangle_mesh.h"

namespace parkade {

/// A chart to be painted, with the heights of its texels.
struct BlankChart {
  TextureChart chart;  ///< `image` black
  cv::Mat height;      ///< CV_32FC1 [m] in site, at the texels' centres; NaN off the mesh
};

/// Divides a mesh into charts that show it from above without folds: one for the triangles of each square of
/// `chart_size` [m]; where decks lie above each other one for each connected piece; where a piece (a spiral ramp) lies
/// above itself one for each band of height. Sorted as GroundTexture says. In parallel, the same every time.
std::vector<BlankChart> CutIntoCharts(const TriangleMesh& mesh, double chart_size, double texel_size);

}  // namespace parkade
