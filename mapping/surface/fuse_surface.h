#pragma once

#include <span>

#include "core/surface_map.h"
#include "mapping/ground/driven_path.h"
#include "mapping/ground/patch_source.h"
#include "mapping/heights/drive_heights.h"
#include "mapping/heights/height_field.h"
#include "mapping/surface/surface_options.h"

namespace parkade {

/// The ground of a site from all its drives.
///
/// 1. Heights: wheel contacts (the surest); beside the path what many views of a drive agree on;
/// and, weakly and weaker
///    with distance, the planes on which keyframes saw ground. A HeightField is fitted to what all
///    drives know (FitHeights).
/// 2. Color and free space: every sample moves along its viewing ray onto that surface, so that a
/// ramp ahead is
///    painted where it is, and not where the car's own plane would have it. Free space is a
///    log-odds sum, bounded; of a drive that contradicts those before it nothing else counts there,
///    and at most `latest_drives` that looked at a place do, by their nearest views (see
///    LatestDrives); a cell's color is the median of its nearest observations; what a car drove
///    over is free, until a later drive sees otherwise.
/// 3. The free space is corrected from above (OutlineNetwork).
/// 4. Pinholes are filled, islands that no car drove on and that are small are dropped.
///
/// 2 to 4 go square by square of `tile_size`: in memory are the patches and the evidence of two
/// squares, and the cells of all. The result does not depend on the squares, but for rounding in 3
/// and for specks of a deck that it leaves out. With the method "homography" FuseVoxels is asked
/// instead. `heights` are those of MeasureDriveHeights, of all drives; `measured` are heights that
/// something else knows. Cells that nothing was seen of are not in the map. The patches of a drive
/// without a path are painted where their own plane says. Same input, same output, whatever the
/// number of threads. O(samples).
SurfaceMap FuseSurface(const PatchSource& patches, std::span<const DrivenPath> paths,
                       std::span<const DriveHeights> heights, const SurfaceOptions& options = {},
                       std::span<const HeightObservation> measured = {});

}  // namespace parkade
