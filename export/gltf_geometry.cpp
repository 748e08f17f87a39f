#include "export/gltf_geometry.h"

#include <limits>

namespace parkade {

std::uint16_t LinearFromSrgb(std::uint8_t value) {
  static const std::array<std::uint16_t, 256> kTable = [] {
    std::array<std::uint16_t, 256> table{};
    for (size_t i = 0; i < table.size(); ++i) {
      const double srgb = static_cast<double>(i) / 255;
      const double linear = srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4);
      table[i] = static_cast<std::uint16_t>(std::lround(linear * 65535));
    }
    return table;
  }();
  return kTable[value];
}

GltfGeometry MakeGltfGeometry(const TriangleMesh& mesh) {
  constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();
  GltfGeometry geometry;
  std::vector<std::uint32_t> new_index(mesh.vertices.size(), kUnused);
  const auto use = [&](std::uint32_t index) {
    if (new_index[index] != kUnused) return new_index[index];
    new_index[index] = static_cast<std::uint32_t>(geometry.positions.size());
    const Eigen::Vector3f& normal = mesh.normals[index];
    const bool has_normal = normal.allFinite() && normal.norm() > 1e-6F;
    const auto& [red, green, blue] = mesh.colors[index];
    geometry.positions.push_back(GltfFromSite(mesh.vertices[index]));
    geometry.normals.push_back(
        GltfFromSite<float>(has_normal ? Eigen::Vector3f(normal.normalized()) : Eigen::Vector3f::UnitZ()));
    geometry.colors.push_back({LinearFromSrgb(red), LinearFromSrgb(green), LinearFromSrgb(blue), 65535});
    geometry.height_sigmas.push_back(mesh.height_sigmas[index]);
    return new_index[index];
  };
  for (const auto& [a, b, c] : mesh.triangles) {
    if (a == b || b == c || c == a) continue;
    const std::uint32_t first = use(a), second = use(b), third = use(c);
    geometry.triangles.push_back({first, second, third});
  }
  return geometry;
}

Box3f BoundingBox(const std::vector<Eigen::Vector3f>& points) {
  if (points.empty()) return {};
  Box3f box{points[0], points[0]};
  for (const Eigen::Vector3f& point : points) {
    box.min = box.min.cwiseMin(point);
    box.max = box.max.cwiseMax(point);
  }
  return box;
}

}  // namespace parkade
