#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "core/rigid3.h"
#include "core/surface_class.h"

namespace parkade {

/// Triangles in the site frame (z up), counter-clockwise seen from above.
/// Holds always: indices in range, no NaN, per-vertex arrays of equal length.
struct TriangleMesh {
  std::vector<Eigen::Vector3f> vertices;            ///< [m] relative to `origin`
  std::vector<Eigen::Vector3f> normals;             ///< unit
  std::vector<std::array<std::uint8_t, 3>> colors;  ///< sRGB
  std::vector<float> height_sigmas;                 ///< [m]
  std::vector<SurfaceClass> surfaces;               ///< empty: not told
  std::vector<std::array<std::uint32_t, 3>> triangles;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< [m] in site; keeps vertices small

  bool empty() const { return triangles.empty(); }
};

/// Throws Error{kInternal} naming the first broken promise.
void ValidateMesh(const TriangleMesh& mesh);

/// The same mesh in another frame.
TriangleMesh Transformed(const TriangleMesh& mesh, const Rigid3& target_from_site);

/// [m^2] of all triangles.
double SurfaceArea(const TriangleMesh& mesh);

}  // namespace parkade
