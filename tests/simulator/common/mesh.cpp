#include "tests/simulator/common/mesh.h"

#include <Eigen/Geometry>
#include <cmath>

#include "tests/simulator/common/noise.h"

namespace parkade::simulator {

std::uint32_t Mesh::AddVertex(const Eigen::Vector3d& position, const Eigen::Vector3d& normal) {
  positions.push_back(position.cast<float>());
  normals.push_back(normal.cast<float>());
  return static_cast<std::uint32_t>(positions.size() - 1);
}

void Mesh::AddTriangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, MaterialId material) {
  triangles.push_back({a, b, c});
  triangle_materials.push_back(material);
}

void Mesh::AddQuad(const std::array<Eigen::Vector3d, 4>& corners, MaterialId material) {
  const Eigen::Vector3d normal =
      (corners[2] - corners[0]).cross(corners[3] - corners[1]).normalized();
  std::array<std::uint32_t, 4> index{};
  for (size_t i = 0; i < 4; ++i) index[i] = AddVertex(corners[i], normal);
  AddTriangle(index[0], index[1], index[2], material);
  AddTriangle(index[0], index[2], index[3], material);
}

void Mesh::AddBox(const Eigen::Vector3d& center, const Eigen::Vector3d& half_size, double yaw,
                  MaterialId material) {
  const Eigen::AngleAxisd turn(yaw, Eigen::Vector3d::UnitZ());
  const auto corner = [&](int x, int y, int z) -> Eigen::Vector3d {
    return center + turn * Eigen::Vector3d(x * half_size.x(), y * half_size.y(), z * half_size.z());
  };
  AddQuad({corner(-1, -1, 1), corner(1, -1, 1), corner(1, 1, 1), corner(-1, 1, 1)}, material);
  AddQuad({corner(-1, 1, -1), corner(1, 1, -1), corner(1, -1, -1), corner(-1, -1, -1)}, material);
  AddQuad({corner(1, -1, -1), corner(1, 1, -1), corner(1, 1, 1), corner(1, -1, 1)}, material);
  AddQuad({corner(-1, 1, -1), corner(-1, -1, -1), corner(-1, -1, 1), corner(-1, 1, 1)}, material);
  AddQuad({corner(1, 1, -1), corner(-1, 1, -1), corner(-1, 1, 1), corner(1, 1, 1)}, material);
  AddQuad({corner(-1, -1, -1), corner(1, -1, -1), corner(1, -1, 1), corner(-1, -1, 1)}, material);
}

void Mesh::AddCylinder(const Eigen::Vector3d& base, const Eigen::Vector3d& top, double base_radius,
                       double top_radius, MaterialId material, int num_sides) {
  const Eigen::Vector3d axis = (top - base).normalized();
  const Eigen::Vector3d u = axis.unitOrthogonal(), v = axis.cross(u);
  const std::uint32_t first = static_cast<std::uint32_t>(positions.size());
  for (int i = 0; i < num_sides; ++i) {
    const double angle = 2 * M_PI * i / num_sides;
    const Eigen::Vector3d out = std::cos(angle) * u + std::sin(angle) * v;
    AddVertex(base + base_radius * out, out);
    AddVertex(top + top_radius * out, out);
  }
  const std::uint32_t count = static_cast<std::uint32_t>(num_sides);
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t low = first + 2 * i, next = first + 2 * ((i + 1) % count);
    AddTriangle(low, next, next + 1, material);
    AddTriangle(low, next + 1, low + 1, material);
  }
  for (const bool is_top : {false, true}) {
    const std::uint32_t center = AddVertex(is_top ? top : base, is_top ? axis : -axis);
    for (std::uint32_t i = 0; i < count; ++i) {
      const Eigen::Vector3d a = positions[first + 2 * i + is_top].cast<double>();
      const Eigen::Vector3d b = positions[first + 2 * ((i + 1) % count) + is_top].cast<double>();
      const std::uint32_t rim = AddVertex(is_top ? a : b, is_top ? axis : -axis);
      AddVertex(is_top ? b : a, is_top ? axis : -axis);
      AddTriangle(center, rim, rim + 1, material);
    }
  }
}

void Mesh::AddSheet(int columns, int rows, const std::function<Eigen::Vector3d(int, int)>& position,
                    const std::function<MaterialId(int, int)>& cell_material) {
  const std::uint32_t first = static_cast<std::uint32_t>(positions.size());
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const Eigen::Vector3d along_i =
          position(std::min(i + 1, columns - 1), j) - position(std::max(i - 1, 0), j);
      const Eigen::Vector3d along_j =
          position(i, std::min(j + 1, rows - 1)) - position(i, std::max(j - 1, 0));
      const Eigen::Vector3d normal = along_i.cross(along_j);
      AddVertex(position(i, j),
                normal.norm() > 1e-12 ? normal.normalized() : Eigen::Vector3d::UnitZ());
    }
  }
  for (int j = 0; j + 1 < rows; ++j) {
    for (int i = 0; i + 1 < columns; ++i) {
      const std::uint32_t a = first + static_cast<std::uint32_t>(j * columns + i), b = a + 1;
      const std::uint32_t d = a + static_cast<std::uint32_t>(columns), c = d + 1;
      AddTriangle(a, b, c, cell_material(i, j));
      AddTriangle(a, c, d, cell_material(i, j));
    }
  }
}

void Mesh::AddPatchedSheet(
    int columns, int rows, const std::function<Eigen::Vector3d(int, int)>& position,
    const std::function<std::optional<MaterialId>(int, int)>& cell_material) {
  std::vector<std::int64_t> indices(static_cast<size_t>(columns) * static_cast<size_t>(rows), -1);
  const auto vertex = [&](int i, int j) {
    std::int64_t& index =
        indices[static_cast<size_t>(j) * static_cast<size_t>(columns) + static_cast<size_t>(i)];
    if (index < 0) {
      const Eigen::Vector3d along_i =
          position(std::min(i + 1, columns - 1), j) - position(std::max(i - 1, 0), j);
      const Eigen::Vector3d along_j =
          position(i, std::min(j + 1, rows - 1)) - position(i, std::max(j - 1, 0));
      index = AddVertex(position(i, j), along_i.cross(along_j).normalized());
    }
    return static_cast<std::uint32_t>(index);
  };
  for (int j = 0; j + 1 < rows; ++j) {
    for (int i = 0; i + 1 < columns; ++i) {
      const std::optional<MaterialId> material = cell_material(i, j);
      if (!material) continue;
      const std::uint32_t a = vertex(i, j), b = vertex(i + 1, j), c = vertex(i + 1, j + 1),
                          d = vertex(i, j + 1);
      AddTriangle(a, b, c, *material);
      AddTriangle(a, c, d, *material);
    }
  }
}

void Mesh::AddBlob(const Eigen::Vector3d& center, const Eigen::Vector3d& radii, double bumpiness,
                   std::uint32_t seed, MaterialId material, int detail) {
  const auto position = [&](int i, int j) -> Eigen::Vector3d {
    const double azimuth = 2 * M_PI * (i % (2 * detail)) / (2 * detail),
                 elevation = M_PI * (static_cast<double>(j) / detail - 0.5);
    const Eigen::Vector3d out(std::cos(elevation) * std::cos(azimuth),
                              std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
    // Two planes of noise make bumps that close around the ellipsoid.
    const float bump = FractalNoise(static_cast<float>(2.7 * out.x() + 3),
                                    static_cast<float>(2.7 * out.y() + 1.3 * out.z()), 3, seed) +
                       FractalNoise(static_cast<float>(2.7 * out.z()),
                                    static_cast<float>(2.7 * out.y() - out.x()), 3, seed + 7);
    return center + (1 + bumpiness * bump) * out.cwiseProduct(radii);
  };
  AddSheet(2 * detail + 1, detail + 1, position, [&](int, int) { return material; });
}

void Mesh::Append(const Mesh& other, const Rigid3& target_from_other) {
  const std::uint32_t first = static_cast<std::uint32_t>(positions.size());
  const Eigen::Matrix3f rotation = target_from_other.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f translation = target_from_other.translation.cast<float>();
  for (size_t i = 0; i < other.positions.size(); ++i) {
    positions.push_back(rotation * other.positions[i] + translation);
    normals.push_back(rotation * other.normals[i]);
  }
  for (const auto& [a, b, c] : other.triangles)
    triangles.push_back({a + first, b + first, c + first});
  triangle_materials.insert(triangle_materials.end(), other.triangle_materials.begin(),
                            other.triangle_materials.end());
}

}  // namespace parkade::simulator
