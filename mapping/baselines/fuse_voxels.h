#pragma once

#include <span>

#include "core/surface_map.h"
#include "mapping/ground/driven_path.h"
#include "mapping/ground/patch_source.h"

namespace parkade {

struct VoxelFusionOptions {
  double voxel_size = 0.1;   ///< [m]; a multiple of the surface's cells
  double truncation = 0.2;   ///< [m] along a ray, before and behind where it meets the plane
  double free_log_odds = 1;  ///< of one observation, for or against
  void Validate() const;     ///< throws Error{kUsage}
};

/// The ground as the seed paper has it, to compare with: every pixel lies where its ray meets the
/// plane on which the car stood (the homography of the rig's ground plane); rays are cast into
/// voxels with a truncated signed distance of constant weight and a belief of being free; the
/// surface is where the distance passes zero. H. Oleynikova et al., "Voxblox: Incremental 3D
/// Euclidean Signed Distance Fields for On-Board MAV Planning", IROS 2017, whose fusion the paper
/// uses. Patches without a path are left out. O(samples).
SurfaceMap FuseVoxels(const PatchSource& patches, std::span<const DrivenPath> paths,
                      double cell_size, const VoxelFusionOptions& options = {});

}  // namespace parkade
