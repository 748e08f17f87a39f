#include "mapping/mesh/mesh_samples.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace parkade {

GroundSquare SquareOf(const Eigen::Vector3d& point, double spacing) {
  return {static_cast<int>(std::floor(point.x() / spacing)),
          static_cast<int>(std::floor(point.y() / spacing))};
}

MeshSamples SampleMesh(const TriangleMesh& mesh, double step) {
  MeshSamples samples;
  for (const Eigen::Vector3f& vertex : mesh.vertices)
    samples.points.push_back(mesh.origin + vertex.cast<double>());
  for (const auto& triangle : mesh.triangles) {
    const Eigen::Vector3d a = samples.points[triangle[0]], b = samples.points[triangle[1]],
                          c = samples.points[triangle[2]];
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    const int parts = std::max(1, static_cast<int>(std::ceil(longest / step)));
    // Rows of points parallel to the side from b to c, from a on.
    std::vector<size_t> last = {triangle[0]};
    for (int i = 1; i <= parts; ++i) {
      std::vector<size_t> row;
      for (int k = 0; k <= i; ++k) {
        if (i == parts && (k == 0 || k == i)) {
          row.push_back(triangle[k == 0 ? 1 : 2]);
        } else {
          const double to_c = static_cast<double>(k) / parts,
                       to_b = static_cast<double>(i - k) / parts;
          row.push_back(samples.points.size());
          samples.points.push_back(a + to_b * (b - a) + to_c * (c - a));
        }
        if (k > 0) samples.links.emplace_back(row[static_cast<size_t>(k) - 1], row.back());
        if (k < i) samples.links.emplace_back(last[static_cast<size_t>(k)], row.back());
        if (k > 0) samples.links.emplace_back(last[static_cast<size_t>(k) - 1], row.back());
      }
      last = std::move(row);
    }
  }
  return samples;
}

NodeSamples GroupSamples(const MeshSamples& samples, double spacing, double level_gap) {
  std::map<GroundSquare, std::vector<size_t>> by_square;
  for (size_t i = 0; i < samples.points.size(); ++i)
    by_square[SquareOf(samples.points[i], spacing)].push_back(i);
  NodeSamples grouped{std::vector<size_t>(samples.points.size()), {}};
  for (auto& [square, members] : by_square) {
    std::sort(members.begin(), members.end(), [&](size_t a, size_t b) {
      return std::pair(samples.points[a].z(), a) < std::pair(samples.points[b].z(), b);
    });
    for (size_t begin = 0, end; begin < members.size(); begin = end) {
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (end = begin; end < members.size(); ++end) {
        const Eigen::Vector3d& point = samples.points[members[end]];
        if (end > begin && point.z() - samples.points[members[end - 1]].z() > level_gap) break;
        sum += point;
        grouped.node_of_sample[members[end]] = grouped.nodes.size();
      }
      grouped.nodes.push_back(sum / static_cast<double>(end - begin));
    }
  }
  return grouped;
}

}  // namespace parkade
