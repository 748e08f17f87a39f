#include "export/gltf/merge_vertices.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <tuple>
#include <utility>

namespace parkade {
namespace {

constexpr double kMaxHeight = 1;  // [m] of a cube: decks are further apart

/// Vertices of edges that have one triangle only.
std::vector<bool> FindOutline(const TriangleMesh& mesh) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const auto& [a, b, c] : mesh.triangles)
    for (const auto& edge : {std::minmax(a, b), std::minmax(b, c), std::minmax(c, a)})
      edges.emplace_back(edge);
  std::sort(edges.begin(), edges.end());
  std::vector<bool> is_outline(mesh.vertices.size());
  for (size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
    while (end < edges.size() && edges[end] == edges[begin]) ++end;
    if (end - begin == 1) is_outline[edges[begin].first] = is_outline[edges[begin].second] = true;
  }
  return is_outline;
}

std::uint32_t Representative(const TriangleMesh& mesh, const std::vector<bool>& is_outline,
                             const std::vector<std::uint32_t>& cube) {
  std::vector<std::uint32_t> candidates;
  std::copy_if(cube.begin(), cube.end(), std::back_inserter(candidates),
               [&](std::uint32_t i) { return is_outline[i]; });
  if (candidates.empty()) candidates = cube;
  Eigen::Vector3f mean = Eigen::Vector3f::Zero();
  for (const std::uint32_t i : candidates)
    mean += mesh.vertices[i] / static_cast<float>(candidates.size());
  return *std::min_element(
      candidates.begin(), candidates.end(), [&](std::uint32_t a, std::uint32_t b) {
        return (mesh.vertices[a] - mean).squaredNorm() < (mesh.vertices[b] - mean).squaredNorm();
      });
}

}  // namespace

std::vector<std::uint32_t> MergeVertices(const TriangleMesh& mesh, double cell) {
  const double height = std::min(cell, kMaxHeight);
  std::map<std::tuple<long, long, long>, std::vector<std::uint32_t>> cubes;
  for (std::uint32_t i = 0; i < mesh.vertices.size(); ++i) {
    const Eigen::Vector3d v = mesh.origin + mesh.vertices[i].cast<double>();
    const auto index = [](double x, double edge) { return std::lround(std::floor(x / edge)); };
    cubes[{index(v.x(), cell), index(v.y(), cell), index(v.z(), height)}].push_back(i);
  }
  const std::vector<bool> is_outline = FindOutline(mesh);
  std::vector<std::uint32_t> representative(mesh.vertices.size());
  for (const auto& [at, cube] : cubes) {
    const std::uint32_t chosen = Representative(mesh, is_outline, cube);
    for (const std::uint32_t i : cube) representative[i] = chosen;
  }
  return representative;
}

}  // namespace parkade
