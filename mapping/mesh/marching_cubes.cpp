#include "mapping/mesh/marching_cubes.h"

#include <algorithm>
#include <map>
#include <utility>

namespace parkade {
namespace {

/// Corners of the six faces, counter-clockwise seen from outside the voxel.
constexpr std::array<std::array<int, 4>, 6> kFaces = {
    {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};

using Edge = std::pair<int, int>;

Edge EdgeOf(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

VoxelTriangles MakeCase(int inside_bits) {
  const auto is_inside = [&](int corner) { return (inside_bits >> corner & 1) != 0; };
  // From the edge where a face's outline leaves the inside to the one where it comes back.
  // Backwards, so that loops turn counter-clockwise around the direction outwards.
  std::map<Edge, Edge> next;
  for (const std::array<int, 4>& face : kFaces)
    for (size_t i = 0; i < 4; ++i) {
      const int from = face[i], to = face[(i + 1) % 4];
      if (!is_inside(from) || is_inside(to)) continue;
      for (size_t k = 1; k < 4; ++k) {
        const int a = face[(i + k) % 4], b = face[(i + k + 1) % 4];
        if (is_inside(a) || !is_inside(b)) continue;
        next[EdgeOf(a, b)] = EdgeOf(from, to);
        break;
      }
    }
  VoxelTriangles triangles;
  while (!next.empty()) {
    std::vector<Edge> loop{next.begin()->first};
    for (auto step = next.begin(); step != next.end(); step = next.find(loop.back())) {
      loop.push_back(step->second);
      next.erase(step);
    }
    loop.pop_back();  // the first again
    const auto edge = [&](size_t i) {
      return VoxelEdge{static_cast<std::uint8_t>(loop[i].first),
                       static_cast<std::uint8_t>(loop[i].second)};
    };
    for (size_t i = 2; i < loop.size(); ++i) triangles.push_back({edge(0), edge(i - 1), edge(i)});
  }
  return triangles;
}

}  // namespace

const std::array<VoxelTriangles, 256>& MarchingCubesCases() {
  static const std::array<VoxelTriangles, 256> cases = [] {
    std::array<VoxelTriangles, 256> all;
    for (int bits = 0; bits < 256; ++bits) all[static_cast<size_t>(bits)] = MakeCase(bits);
    return all;
  }();
  return cases;
}

}  // namespace parkade
