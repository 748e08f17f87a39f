#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "core/rigid3.h"
#include "core/surface_class.h"
#include "tests/simulator/common/color.h"
#include "tests/simulator/common/mip_texture.h"

namespace parkade::simulator {

/// How a surface reflects light.
struct Material {
  Color albedo = Gray(0.5f);  ///< diffuse reflectance
  Color emission = Gray(0);   ///< radiance of its own
  float mirror = 0;           ///< share of light reflected as by a mirror, seen head-on
  TextureKind texture = TextureKind::kNone;
  float texture_size = 1;      ///< [m] one period
  float texture_contrast = 0;  ///< root mean square of relative brightness
  SurfaceClass surface = SurfaceClass::kStructure;
};

using MaterialId = std::uint16_t;

/// Triangles with a material each and a normal per vertex (vertices are shared
/// where a surface is smooth). Frame: the world, or the body for the own car.
struct Mesh {
  std::vector<Eigen::Vector3f> positions;  ///< [m]
  std::vector<Eigen::Vector3f> normals;    ///< unit, outward
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<MaterialId> triangle_materials;

  /// A flat polygon a, b, c, d, counter-clockwise seen from outside.
  void AddQuad(const std::array<Eigen::Vector3d, 4>& corners, MaterialId material);

  /// A box about `center`, turned by `yaw`; half sizes along its own axes.
  void AddBox(const Eigen::Vector3d& center, const Eigen::Vector3d& half_size, double yaw,
              MaterialId material);

  /// A cone stump from `base` to `top` with both ends closed.
  void AddCylinder(const Eigen::Vector3d& base, const Eigen::Vector3d& top, double base_radius,
                   double top_radius, MaterialId material, int num_sides = 12);

  /// A smooth surface over a grid: `position(i, j)` for i < columns, j < rows.
  /// Outside is the side from which i runs right and j runs up.
  void AddSheet(int columns, int rows, const std::function<Eigen::Vector3d(int, int)>& position,
                const std::function<MaterialId(int, int)>& cell_material);

  /// As AddSheet, but only the cells that have a material: holes where there is none.
  void AddPatchedSheet(int columns, int rows,
                       const std::function<Eigen::Vector3d(int, int)>& position,
                       const std::function<std::optional<MaterialId>(int, int)>& cell_material);

  /// An ellipsoid with bumps, for crowns and bushes; `bumpiness` is relative to the radius.
  void AddBlob(const Eigen::Vector3d& center, const Eigen::Vector3d& radii, double bumpiness,
               std::uint32_t seed, MaterialId material, int detail = 14);

  /// Everything of `other`, moved.
  void Append(const Mesh& other, const Rigid3& target_from_other);

 private:
  std::uint32_t AddVertex(const Eigen::Vector3d& position, const Eigen::Vector3d& normal);
  void AddTriangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, MaterialId material);
};

}  // namespace parkade::simulator
