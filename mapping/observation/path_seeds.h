#pragma once

#include <cstdint>
#include <vector>

#include "core/trajectory.h"
#include "mapping/ground/ground_grid.h"
#include "mapping/ground/wheelbase_footprint.h"

namespace parkade {

/// Cells of the grid where the car itself drives within a few seconds before or after `time` (the
/// drive is replayed: its future is known), or that lie right beside it. One per cell, non-zero
/// where road. These places are road for certain, which is what a segmentation without training
/// needs to start from.
std::vector<std::uint8_t> FindPathSeeds(const GroundGrid& grid, const Trajectory& odom_from_body,
                                        Timestamp time, const Rigid3& body_from_ground,
                                        const WheelbaseFootprint& contact);

}  // namespace parkade
