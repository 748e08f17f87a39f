#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "core/ground_texture.h"
#include "core/triangle_mesh.h"

namespace parkade {

/// glTF is y-up: (x, y, z) of the site becomes (x, z, -y). The only place where this happens.
template <typename Scalar>
Eigen::Matrix<Scalar, 3, 1> GltfFromSite(const Eigen::Matrix<Scalar, 3, 1>& in_site) {
  return {in_site.x(), in_site.z(), -in_site.y()};
}

/// A mesh as glTF wants it: y up, linear colors, unit normals, no vertex without a triangle and no
/// triangle with two equal corners. Arrays of vertices have the same length.
struct GltfGeometry {
  std::vector<Eigen::Vector3f> positions;  ///< [m] relative to the mesh's origin
  std::vector<Eigen::Vector3f> normals;
  std::vector<std::array<std::uint16_t, 4>>
      colors;  ///< linear RGBA, normalized: 8 bits would band dark asphalt;
               ///< empty where there is a texture, which it would darken
  std::vector<Eigen::Vector2f>
      texcoords;                     ///< (0, 0) is the image's upper left; empty without texture
  std::vector<float> height_sigmas;  ///< [m]
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// The whole mesh, with vertex colors.
GltfGeometry MakeGltfGeometry(const TriangleMesh& mesh);

/// The triangles that a chart paints, with its texture.
GltfGeometry MakeGltfGeometry(const TriangleMesh& mesh, const TextureChart& chart,
                              double texel_size);

/// 16-bit linear value of an 8-bit sRGB one (IEC 61966-2-1).
std::uint16_t LinearFromSrgb(std::uint8_t value);

/// Corners of the box around points; both zero where there are none.
struct Box3f {
  Eigen::Vector3f min = Eigen::Vector3f::Zero();
  Eigen::Vector3f max = Eigen::Vector3f::Zero();
};
Box3f BoundingBox(const std::vector<Eigen::Vector3f>& points);

}  // namespace parkade
