#pragma once

#include <map>
#include <string>

#include "export/gltf/gltf_geometry.h"

namespace parkade {

/// A compressed mesh and what KHR_draco_mesh_compression says about it.
struct DracoMesh {
  std::string bytes;
  std::map<std::string, int> attribute_ids;  ///< by glTF semantic
  size_t num_vertices =
      0;  ///< after decoding; more than before where the surface is not a manifold
  size_t num_triangles = 0;
};

/// Positions are rounded to a lattice of 2^-9 m (at most 1 mm off) whose points lie at multiples of
/// its step, so that meshes whose origins are such multiples too meet within a micrometer (Draco
/// keeps six decimals). Above 512 m the step doubles until 18 bits are enough: more breaks decoders
/// (CesiumGS/gltf-pipeline#609). Same geometry, same bytes.
DracoMesh EncodeDraco(const GltfGeometry& geometry);

/// [m] the lattice's step for a mesh of this extent.
double DracoStep(double extent);

}  // namespace parkade
