#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "mapping/ground/ground_grid.h"
#include "mapping/ground/ground_label.h"

namespace parkade {

/// A guess of what is road, without a network: the road's colors and their roughness are learnt
/// from the `seeds` (places where the car has just driven, or is about to) as a few clusters, and
/// grown from them over neighboring places that look alike. Thin bright stripes inside are paint.
/// Conservative: what looks unlike the road is not ground. Follow it with HideBehindObstacles.
///
/// \param colors  of SampleColors
/// \param seeds   one per cell of the grid, non-zero where the road is known
/// \return one per cell of the grid
std::vector<GroundLabel> SegmentByColor(const GroundGrid& grid, const cv::Mat& colors,
                                        const std::vector<std::uint8_t>& seeds);

}  // namespace parkade
