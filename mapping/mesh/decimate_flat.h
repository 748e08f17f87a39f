#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "mapping/mesh/height_mesh.h"

namespace parkade {

struct DecimateFlatOptions {
  double max_error =
      5e-4;  ///< [m] that a vertex which goes may lie off the ground that is left there
  double max_edge = 0.5;  ///< [m] of what is left
  int color_contrast =
      12;  ///< between vertices whose colors differ more (of 255, any channel) none goes
};

/// Takes vertices out of flat ground of one color, which triangulation fills with triangles as
/// small as its squares: an even, cheap decimation before edges collapse in order of their cost. In
/// each of a few rounds go vertices no two of which are neighbors, each into a neighbor (a
/// half-edge collapse). Borders stay, and so does `is_kept`. \param colors   one per vertex \param
/// is_kept  one per vertex \return for each vertex that is left which one of the given it was, in
/// their order. Deterministic.
std::vector<std::uint32_t> DecimateFlat(const std::vector<std::array<std::uint8_t, 3>>& colors,
                                        const std::vector<bool>& is_kept,
                                        const DecimateFlatOptions& options, HeightMesh& mesh);

/// Whether two colors are further apart than that in any channel.
bool HasContrast(const std::array<std::uint8_t, 3>& a, const std::array<std::uint8_t, 3>& b,
                 int contrast);

}  // namespace parkade
