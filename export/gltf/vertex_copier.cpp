#include "export/gltf/vertex_copier.h"

#include "export/gltf/draco_encoder.h"

namespace parkade {

VertexCopier::VertexCopier(const TriangleMesh& source, const Eigen::Vector3d& origin)
    : source_(source) {
  mesh_.origin = origin;
}

void VertexCopier::AddTriangle(const std::array<std::uint32_t, 3>& triangle) {
  mesh_.triangles.push_back({Copy(triangle[0]), Copy(triangle[1]), Copy(triangle[2])});
}

std::uint32_t VertexCopier::Copy(std::uint32_t index) {
  const auto [entry, is_new] =
      new_index_.emplace(index, static_cast<std::uint32_t>(mesh_.vertices.size()));
  if (!is_new) return entry->second;
  const double step = DracoStep(0);
  const Eigen::Vector3d in_site = source_.origin + source_.vertices[index].cast<double>();
  const Eigen::Vector3d on_lattice = (in_site / step).array().round() * step;
  mesh_.vertices.emplace_back((on_lattice - mesh_.origin).cast<float>());
  mesh_.normals.push_back(source_.normals[index]);
  mesh_.colors.push_back(source_.colors[index]);
  mesh_.height_sigmas.push_back(source_.height_sigmas[index]);
  return entry->second;
}

}  // namespace parkade
