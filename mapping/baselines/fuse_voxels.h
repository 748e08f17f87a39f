#pragma once

#include <span>

#include "core/surface_map.h"
#include "mapping/ground/driven_path.h"
#include "mapping/ground/patch_source.h"

namespace parkade {

/// The ground as the seed paper has it, to compare with: every pixel lies where its ray meets the
/// plane on which the car stood (the homography of the rig's ground plane); rays are cast into
/// voxels with a truncated signed distance of constant weight and a belief of being free; the
/// surface is where the distance passes zero. H. Oleynikova et al., "Voxblox: Incremental 3D
/// Euclidean Signed Distance Fields for On-Board MAV Planning", IROS 2017, whose fusion the paper
/// uses. Patches without a path are left out. O(samples).
SurfaceMap FuseVoxels(const PatchSource& patches, std::span<const DrivenPath> paths,
                      double cell_size);

}  // namespace parkade
