#include "export/point_cloud.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace parkade {
namespace {

/// Barycentric coordinates of (x, y) in the triangle (a, b, c); negative outside.
Eigen::Vector3d BarycentricAt(const std::array<Eigen::Vector3d, 3>& corners, double x, double y) {
  const auto& [a, b, c] = corners;
  const auto cross = [&](const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    return (to.x() - from.x()) * (y - from.y()) - (to.y() - from.y()) * (x - from.x());
  };
  const double area = (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
  if (std::abs(area) < 1e-12) return Eigen::Vector3d::Constant(-1);
  return Eigen::Vector3d(cross(b, c), cross(c, a), cross(a, b)) / area;
}

}  // namespace

std::vector<ColoredPoint> SamplePoints(const TriangleMesh& mesh, double spacing) {
  std::vector<ColoredPoint> points;
  for (const auto& triangle : mesh.triangles) {
    std::array<Eigen::Vector3d, 3> corners;
    for (std::size_t i = 0; i < 3; ++i)
      corners[i] = mesh.origin + mesh.vertices[triangle[i]].cast<double>();
    const auto [min_x, max_x] = std::minmax({corners[0].x(), corners[1].x(), corners[2].x()});
    const auto [min_y, max_y] = std::minmax({corners[0].y(), corners[1].y(), corners[2].y()});
    // Half-open: a point on an edge that two triangles share belongs to the upper right one.
    for (double row = std::ceil(min_y / spacing); row * spacing < max_y; ++row)
      for (double column = std::ceil(min_x / spacing); column * spacing < max_x; ++column) {
        const double x = column * spacing, y = row * spacing;
        const Eigen::Vector3d share = BarycentricAt(corners, x, y);
        if (share.minCoeff() < 0) continue;
        ColoredPoint& point = points.emplace_back();
        Eigen::Vector3d color = Eigen::Vector3d::Zero();
        double z = 0;
        for (std::size_t i = 0; i < 3; ++i) {
          z += share[static_cast<Eigen::Index>(i)] * corners[i].z();
          for (std::size_t c = 0; c < 3; ++c)
            color[static_cast<Eigen::Index>(c)] +=
                share[static_cast<Eigen::Index>(i)] * mesh.colors[triangle[i]][c];
        }
        point.point_in_site = Eigen::Vector3d(x, y, z).cast<float>();
        for (std::size_t c = 0; c < 3; ++c)
          point.color[c] =
              static_cast<std::uint8_t>(std::lround(color[static_cast<Eigen::Index>(c)]));
      }
  }
  return points;
}

std::string EncodePcd(const std::vector<ColoredPoint>& points) {
  const std::string count = std::to_string(points.size());
  std::string bytes =
      "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z rgb\nSIZE 4 4 4 "
      "4\nTYPE F F F F\n"
      "COUNT 1 1 1 1\nWIDTH " +
      count + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + count + "\nDATA binary\n";
  bytes.reserve(bytes.size() + 16 * points.size());
  for (const ColoredPoint& point : points) {
    const std::uint32_t rgb = (std::uint32_t{point.color[0]} << 16) |
                              (std::uint32_t{point.color[1]} << 8) | point.color[2];
    std::array<char, 16> record;
    std::memcpy(record.data(), point.point_in_site.data(), 12);
    std::memcpy(record.data() + 12, &rgb, 4);
    bytes.append(record.data(), record.size());
  }
  return bytes;
}

}  // namespace parkade
