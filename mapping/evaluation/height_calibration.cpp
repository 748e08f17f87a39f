#include "mapping/evaluation/height_calibration.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace parkade {

double PercentBeyondTwoSigmas(
    const TriangleMesh& mesh,
    const std::function<std::optional<double>(const Eigen::Vector3d&)>& true_height) {
  constexpr double kSide = 0.2;  // [m] of the parts that triangles are cut into
  if (mesh.height_sigmas.size() != mesh.vertices.size()) return 0;
  double area = 0, beyond = 0;
  for (const auto& triangle : mesh.triangles) {
    std::array<Eigen::Vector3d, 3> corners;
    std::array<double, 3> sigmas{};
    for (std::size_t i = 0; i < 3; ++i) {
      corners[i] = mesh.origin + mesh.vertices[triangle[i]].cast<double>();
      sigmas[i] = static_cast<double>(mesh.height_sigmas[triangle[i]]);
    }
    const Eigen::Vector3d first = corners[1] - corners[0], second = corners[2] - corners[0];
    const double longest = std::max({first.norm(), second.norm(), (second - first).norm()});
    const int parts = std::max(1, static_cast<int>(std::ceil(longest / kSide)));
    const double part_area =
        0.5 * std::abs(first.x() * second.y() - first.y() * second.x()) / (parts * parts);
    // The middles of the equal small triangles that lie as the large one does, and of the others.
    for (int i = 0; i < parts; ++i)
      for (int k = 0; k + i < parts; ++k)
        for (const double at : {1.0 / 3, 2.0 / 3}) {
          const double u = (i + at) / parts, v = (k + at) / parts;
          if (u + v >= 1) continue;
          const Eigen::Vector3d point = corners[0] + u * first + v * second;
          const std::optional<double> height = true_height(point);
          if (!height) continue;
          const double sigma = (1 - u - v) * sigmas[0] + u * sigmas[1] + v * sigmas[2];
          area += part_area;
          if (std::abs(point.z() - *height) > 2 * sigma) beyond += part_area;
        }
  }
  return area > 0 ? 100 * beyond / area : 0;
}

}  // namespace parkade
