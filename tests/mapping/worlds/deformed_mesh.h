#pragma once

#include "mapping/mesh/deform_mesh.h"

namespace parkade {

/// The whole mesh moved, its normals turned; the same triangles.
inline TriangleMesh Deformed(const TriangleMesh& mesh, const MeshDeformation& deformation) {
  constexpr double kArm = 0.1;  // [m] along a normal, to see it turn
  TriangleMesh moved = mesh;
  if (mesh.vertices.empty()) return moved;
  moved.origin =
      deformation.Apply(mesh.origin + mesh.vertices.front().cast<double>()).array().round();
  for (size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Eigen::Vector3d point = mesh.origin + mesh.vertices[i].cast<double>();
    const Eigen::Vector3d at = deformation.Apply(point);
    moved.vertices[i] = (at - moved.origin).cast<float>();
    const Eigen::Vector3d tip = deformation.Apply(point + kArm * mesh.normals[i].cast<double>());
    moved.normals[i] = (tip - at).normalized().cast<float>();
  }
  return moved;
}

}  // namespace parkade
