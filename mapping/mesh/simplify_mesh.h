#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "mapping/mesh/height_mesh.h"

namespace parkade {

struct SimplifyMeshOptions {
  double max_error = 0.01;  ///< [m] off the planes of the triangles that were merged
  int color_contrast =
      12;  ///< edges between vertices whose colors differ more (of 255, any channel) stay
  double tile_size = 12.0;  ///< [m] of the pieces simplified in parallel; their seams stay
};

/// One square of a simplified mesh.
struct SimplifiedPiece {
  static constexpr std::uint32_t kNoSeam = UINT32_MAX;

  int column = 0, row = 0;           ///< of the square, in tile sizes from the site's origin
  HeightMesh mesh;                   ///< has its own vertices
  std::vector<std::uint32_t> seams;  ///< for each of its vertices the one of the whole mesh that
                                     ///< it shares with other pieces; kNoSeam inside
};

/// The same mesh with fewer triangles, in pieces by row, then column: edges collapse in order of
/// the quadric error of M. Garland, P. Heckbert, "Surface simplification using quadric error
/// metrics", SIGGRAPH 1997 (CGAL), no triangle turns over, borders keep their course, edges of
/// color and seams between pieces stay where they are. A triangle belongs to the square that its
/// center lies in. \param colors  one per vertex \param wanted  [squares] pieces that are made, the
/// last being the one before max(); nothing: all
std::vector<SimplifiedPiece> SimplifyPieces(const HeightMesh& mesh,
                                            const std::vector<std::array<std::uint8_t, 3>>& colors,
                                            const SimplifyMeshOptions& options,
                                            const std::optional<Eigen::AlignedBox2i>& wanted = {});

/// The pieces as one mesh: what they share at their seams becomes one vertex. \return for each
/// piece the vertices of the result that its own became.
std::vector<std::vector<std::uint32_t>> JoinPieces(std::span<const SimplifiedPiece> pieces,
                                                   HeightMesh& joined);

}  // namespace parkade
