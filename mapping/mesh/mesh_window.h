#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "core/surface_map.h"
#include "mapping/mesh/mesh_options.h"
#include "mapping/mesh/simplify_mesh.h"

namespace parkade {

/// A square of the site's mesh.
struct MeshPiece {
  SimplifiedPiece simplified;
  std::vector<std::array<std::uint8_t, 3>> colors;  ///< of its vertices
  std::vector<float> height_sigmas;                 ///< [m]
  std::vector<SurfaceClass> surfaces;
};

/// What is meshed at once.
struct MeshWindow {
  Eigen::AlignedBox2i
      tiles;  ///< squares of SimplifyMeshOptions::tile_size; the last is the one before max()
  Eigen::AlignedBox2i
      cells;  ///< with those around, so that within `tiles` all is as if the whole site were there
  std::size_t num_cells = 0;  ///< about as many hold something
};

/// The windows of about `options.window_size` that may hold triangles, by row, then column.
std::vector<MeshWindow> CutIntoWindows(const SurfaceMap& surface, const MeshOptions& options);

/// The mesh of one window.
struct WindowMesh {
  HeightMesh height_mesh;  ///< before it was simplified
  std::vector<MeshPiece> pieces;
  std::size_t num_full_triangles = 0;  ///< before they were simplified, of all pieces
};

WindowMesh MeshWindowOf(const SurfaceMap& surface, const MeshWindow& window,
                        const MeshOptions& options);

/// All cells as one window and one piece, not simplified.
WindowMesh MeshWithoutSimplifying(const SurfaceMap& surface, const MeshOptions& options);

/// Gives vertices at seams numbers that windows agree upon: by where they are, and of several at
/// one place (DuplicateNonManifoldVertices) by their order, which is that of the cells.
class SeamNumbers {
 public:
  void Renumber(const HeightMesh& mesh, std::vector<MeshPiece>& pieces);

 private:
  using Place = std::array<double, 3>;
  struct HashOfPlace {
    std::size_t operator()(const Place& place) const;
  };
  static Place PlaceOf(const Eigen::Vector3d& vertex) {
    return {vertex.x(), vertex.y(), vertex.z()};
  }

  std::unordered_map<Place, std::vector<std::uint32_t>, HashOfPlace>
      numbers_;  // of the vertices at a place
  std::uint32_t next_ = 0;
};

}  // namespace parkade
