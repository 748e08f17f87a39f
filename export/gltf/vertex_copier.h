#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>

#include "core/triangle_mesh.h"

namespace parkade {

/// Copies triangles of one mesh to another with an origin of its own, each vertex once. Vertices
/// are rounded to Draco's lattice in the site: one on the seam between two such meshes is the same
/// in both, to the bit.
class VertexCopier {
 public:
  /// `source` is borrowed; `origin` [m] lies on the lattice.
  VertexCopier(const TriangleMesh& source, const Eigen::Vector3d& origin);

  void AddTriangle(const std::array<std::uint32_t, 3>& triangle);
  const TriangleMesh& mesh() const { return mesh_; }
  TriangleMesh Take() { return std::move(mesh_); }

 private:
  std::uint32_t Copy(std::uint32_t index);

  const TriangleMesh& source_;
  TriangleMesh mesh_;
  std::unordered_map<std::uint32_t, std::uint32_t> new_index_;
};

}  // namespace parkade
