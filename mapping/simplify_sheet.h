#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "mapping/voxel_sheet.h"

namespace parkade {

struct SimplifySheetOptions {
  double max_error = 0.01;  ///< [m] off the planes of the triangles that were merged
  int color_contrast = 12;  ///< edges between vertices whose colours differ more (of 255, any channel) stay
  double tile_size = 12.0;  ///< [m] of the pieces simplified in parallel; their seams stay
};

/// The same sheet with fewer triangles: edges collapse in order of the quadric error of M. Garland, P. Heckbert,
/// "Surface simplification using quadric error metrics", SIGGRAPH 1997 (CGAL), no triangle turns over, borders keep
/// their course, edges of colour stay where they are.
/// \param colors  one per vertex
VoxelSheet SimplifySheet(const VoxelSheet& sheet, const std::vector<std::array<std::uint8_t, 3>>& colors,
                         const SimplifySheetOptions& options);

}  // namespace parkade
