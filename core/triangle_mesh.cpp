#include "core/triangle_mesh.h"

#include <Eigen/Geometry>

#include "core/error.h"

namespace parkade {

void ValidateMesh(const TriangleMesh& mesh) {
  const size_t count = mesh.vertices.size();
  Require(mesh.normals.size() == count && mesh.colors.size() == count &&
              mesh.height_sigmas.size() == count &&
              (mesh.surfaces.empty() || mesh.surfaces.size() == count),
          ErrorCode::kInternal, "a mesh has per-vertex arrays of different lengths");
  for (const Eigen::Vector3f& vertex : mesh.vertices)
    Require(vertex.allFinite(), ErrorCode::kInternal, "a mesh has a vertex that is not finite");
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t index : triangle)
      Require(index < count, ErrorCode::kInternal, "a mesh has a triangle beyond its vertices");
}

TriangleMesh Transformed(const TriangleMesh& mesh, const Rigid3& target_from_site) {
  TriangleMesh moved = mesh;
  moved.origin = target_from_site * mesh.origin;
  const Eigen::Matrix3f rotation = target_from_site.rotation.toRotationMatrix().cast<float>();
  for (Eigen::Vector3f& vertex : moved.vertices) vertex = rotation * vertex;
  for (Eigen::Vector3f& normal : moved.normals) normal = rotation * normal;
  return moved;
}

double SurfaceArea(const TriangleMesh& mesh) {
  double area = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Eigen::Vector3f ab = mesh.vertices[b] - mesh.vertices[a];
    const Eigen::Vector3f ac = mesh.vertices[c] - mesh.vertices[a];
    area += 0.5 * static_cast<double>(ab.cross(ac).norm());
  }
  return area;
}

}  // namespace parkade
