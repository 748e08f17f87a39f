#include "export/gltf/gltf_geometry.h"

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

namespace {

/// Takes triangles of a mesh one by one; vertices come along as they are used.
class GeometryCollector {
 public:
  explicit GeometryCollector(const TriangleMesh& mesh, const TextureChart* chart = nullptr,
                             double texel_size = 0)
      : mesh_(mesh),
        chart_(chart),
        texel_size_(texel_size),
        new_index_(mesh.vertices.size(), kUnused) {}

  void Add(const std::array<std::uint32_t, 3>& triangle) {
    const auto& [a, b, c] = triangle;
    if (a == b || b == c || c == a) return;
    const std::uint32_t first = Use(a), second = Use(b), third = Use(c);
    geometry_.triangles.push_back({first, second, third});
  }
  GltfGeometry Take() { return std::move(geometry_); }

 private:
  static constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();

  std::uint32_t Use(std::uint32_t index) {
    if (new_index_[index] != kUnused) return new_index_[index];
    new_index_[index] = static_cast<std::uint32_t>(geometry_.positions.size());
    const Eigen::Vector3f& normal = mesh_.normals[index];
    const bool has_normal = normal.allFinite() && normal.norm() > 1e-6F;
    geometry_.positions.push_back(GltfFromSite(mesh_.vertices[index]));
    geometry_.normals.push_back(GltfFromSite<float>(
        has_normal ? Eigen::Vector3f(normal.normalized()) : Eigen::Vector3f::UnitZ()));
    geometry_.height_sigmas.push_back(mesh_.height_sigmas[index]);
    if (chart_ != nullptr) {
      geometry_.texcoords.push_back(
          TexcoordOf(mesh_.origin + mesh_.vertices[index].cast<double>()));
    } else {
      const auto& [red, green, blue] = mesh_.colors[index];
      geometry_.colors.push_back(
          {LinearFromSrgb(red), LinearFromSrgb(green), LinearFromSrgb(blue), 65535});
    }
    return new_index_[index];
  }

  Eigen::Vector2f TexcoordOf(const Eigen::Vector3d& in_site) const {
    const double u = (in_site.x() - chart_->left) / (texel_size_ * chart_->image.cols);
    const double v = (chart_->top - in_site.y()) / (texel_size_ * chart_->image.rows);
    return {static_cast<float>(u), static_cast<float>(v)};
  }

  const TriangleMesh& mesh_;
  const TextureChart* chart_;
  double texel_size_;
  std::vector<std::uint32_t> new_index_;
  GltfGeometry geometry_;
};

}  // namespace

GltfGeometry MakeGltfGeometry(const TriangleMesh& mesh) {
  GeometryCollector collector(mesh);
  for (const auto& triangle : mesh.triangles) collector.Add(triangle);
  return collector.Take();
}

GltfGeometry MakeGltfGeometry(const TriangleMesh& mesh, const TextureChart& chart,
                              double texel_size) {
  GeometryCollector collector(mesh, &chart, texel_size);
  for (const std::uint32_t triangle : chart.triangles) collector.Add(mesh.triangles[triangle]);
  return collector.Take();
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
