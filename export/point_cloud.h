#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/triangle_mesh.h"

namespace parkade {

struct ColoredPoint {
  Eigen::Vector3f point_in_site;        ///< [m]
  std::array<std::uint8_t, 3> color{};  ///< sRGB
};

/// Points on a mesh where the vertical lines of a square lattice meet it, every `spacing` [m];
/// colors as the triangle's corners have them. Decks above each other are all there. In order of
/// triangles.
std::vector<ColoredPoint> SamplePoints(const TriangleMesh& mesh, double spacing);

/// PCD 0.7, binary: x y z and rgb packed into the bits of a float, as PCL and Autoware read it.
std::string EncodePcd(const std::vector<ColoredPoint>& points);

}  // namespace parkade
