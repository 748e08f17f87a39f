#include "mapping/mesh/height_mesh.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <span>
#include <unordered_map>

#include "mapping/ground/surface_links.h"

namespace parkade {
namespace {

/// Triangulates the squares between the centers of four cells.
class Triangulator {
 public:
  Triangulator(const SurfaceMap& surface, double max_step)
      : surface_(surface), links_(LinkCells(surface, max_step)) {
    vertex_of_cell_.assign(surface.cells.size(), kNone);
  }

  HeightMesh Run() {
    for (size_t i = 0; i < surface_.cells.size(); ++i) {
      const int right = links_.right[i], up = links_.up[i];
      if (right < 0 || up < 0) continue;
      const int diagonal = links_.up[static_cast<size_t>(right)];
      if (diagonal < 0 || diagonal != links_.right[static_cast<size_t>(up)]) continue;
      AddSquare(static_cast<int>(i), right, diagonal, up);
    }
    return std::move(mesh_);
  }

  /// One entry per vertex of the mesh.
  const std::vector<double>& beliefs() const { return beliefs_; }

 private:
  static constexpr std::uint32_t kNone = UINT32_MAX;

  /// Corners counter-clockwise from the lower left one, as its diagonal goes.
  void AddSquare(int a, int b, int c, int d) {
    const std::uint32_t first = VertexOf(a), second = VertexOf(b), third = VertexOf(c),
                        fourth = VertexOf(d);
    mesh_.triangles.push_back({first, second, third});
    mesh_.triangles.push_back({first, third, fourth});
  }

  std::uint32_t VertexOf(int cell) {
    std::uint32_t& vertex = vertex_of_cell_[static_cast<size_t>(cell)];
    if (vertex != kNone) return vertex;
    const SurfaceCell& c = surface_.cells[static_cast<size_t>(cell)];
    vertex = static_cast<std::uint32_t>(mesh_.vertices.size());
    mesh_.vertices.emplace_back((c.x + 0.5) * surface_.cell_size, (c.y + 0.5) * surface_.cell_size,
                                static_cast<double>(c.height));
    beliefs_.push_back(static_cast<double>(c.free_belief));
    return vertex;
  }

  const SurfaceMap& surface_;
  SurfaceLinks links_;
  std::vector<std::uint32_t> vertex_of_cell_;
  HeightMesh mesh_;
  std::vector<double> beliefs_;
};

/// Cuts a mesh where values on its vertices, linear in between, pass zero; what is negative goes.
/// Edges are cut not nearer to their ends than kMinCut of their length: no slivers.
class MeshCutter {
 public:
  MeshCutter(const HeightMesh& mesh, std::vector<double> values)
      : mesh_(mesh), values_(std::move(values)) {
    kept_.assign(mesh.vertices.size(), kNone);
  }

  HeightMesh Cut() {
    for (const auto& triangle : mesh_.triangles) {
      // Corners that stay and the cuts between them, in order around the triangle.
      std::array<std::uint32_t, 4> outline{};
      size_t count = 0;
      for (size_t i = 0; i < 3; ++i) {
        const std::uint32_t a = triangle[i], b = triangle[(i + 1) % 3];
        if (values_[a] >= 0) outline[count++] = Keep(a);
        if ((values_[a] >= 0) != (values_[b] >= 0)) outline[count++] = CutEdge(a, b);
      }
      for (size_t i = 2; i < count; ++i)
        result_.triangles.push_back({outline[0], outline[i - 1], outline[i]});
    }
    return std::move(result_);
  }

 private:
  static constexpr std::uint32_t kNone = UINT32_MAX;
  static constexpr double kMinCut = 0.03;

  std::uint32_t Add(const Eigen::Vector3d& vertex) {
    result_.vertices.push_back(vertex);
    return static_cast<std::uint32_t>(result_.vertices.size() - 1);
  }

  std::uint32_t Keep(std::uint32_t vertex) {
    if (kept_[vertex] == kNone) kept_[vertex] = Add(mesh_.vertices[vertex]);
    return kept_[vertex];
  }

  std::uint32_t CutEdge(std::uint32_t a, std::uint32_t b) {
    if (a > b) std::swap(a, b);
    const auto [found, is_new] = cuts_.try_emplace((std::uint64_t{a} << 32) | b, 0);
    if (is_new) {
      const double fraction =
          std::clamp(values_[a] / (values_[a] - values_[b]), kMinCut, 1 - kMinCut);
      found->second = Add(mesh_.vertices[a] + fraction * (mesh_.vertices[b] - mesh_.vertices[a]));
    }
    return found->second;
  }

  const HeightMesh& mesh_;
  std::vector<double> values_;
  std::vector<std::uint32_t> kept_;
  std::unordered_map<std::uint64_t, std::uint32_t> cuts_;
  HeightMesh result_;
};

/// Triangles of one vertex in groups that share edges: for each the number of the first in its
/// group.
std::vector<size_t> GroupByEdges(const HeightMesh& mesh, std::uint32_t vertex,
                                 std::span<const std::uint32_t> around) {
  const auto share_edge = [&](std::uint32_t s, std::uint32_t t) {
    for (const std::uint32_t p : mesh.triangles[s])
      for (const std::uint32_t q : mesh.triangles[t])
        if (p == q && p != vertex) return true;
    return false;
  };
  std::vector<size_t> group(around.size());
  std::iota(group.begin(), group.end(), size_t{0});
  // Few triangles meet at a vertex: comparing all pairs until nothing changes is quick.
  for (bool has_changed = true; has_changed;) {
    has_changed = false;
    for (size_t i = 0; i < around.size(); ++i)
      for (size_t k = i + 1; k < around.size(); ++k)
        if (group[i] != group[k] && share_edge(around[i], around[k])) {
          group[i] = group[k] = std::min(group[i], group[k]);
          has_changed = true;
        }
  }
  return group;
}

/// True when the triangles around a vertex are one group: n triangles have n (closed) or n + 1
/// (open) neighbors.
bool IsManifold(const HeightMesh& mesh, std::uint32_t vertex, std::span<const std::uint32_t> around,
                std::vector<std::uint32_t>& neighbors) {
  neighbors.clear();
  for (const std::uint32_t triangle : around)
    for (const std::uint32_t corner : mesh.triangles[triangle])
      if (corner != vertex) neighbors.push_back(corner);
  std::sort(neighbors.begin(), neighbors.end());
  const auto num_neighbors = std::unique(neighbors.begin(), neighbors.end()) - neighbors.begin();
  return num_neighbors <= static_cast<std::ptrdiff_t>(around.size()) + 1;
}

}  // namespace

std::vector<std::uint32_t> DuplicateNonManifoldVertices(HeightMesh& mesh) {
  // Triangles of vertex v: around_all[begin[v]] .. around_all[begin[v + 1]].
  std::vector<size_t> begin(mesh.vertices.size() + 1);
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t vertex : triangle) ++begin[vertex + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<std::uint32_t> around_all(begin.back());
  std::vector<size_t> next = begin;
  for (size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::uint32_t vertex : mesh.triangles[t])
      around_all[next[vertex]++] = static_cast<std::uint32_t>(t);

  std::vector<std::uint32_t> copied, neighbors;
  for (std::uint32_t vertex = 0; vertex + 1 < begin.size(); ++vertex) {
    const std::span<const std::uint32_t> around(around_all.data() + begin[vertex],
                                                begin[vertex + 1] - begin[vertex]);
    if (IsManifold(mesh, vertex, around, neighbors)) continue;
    const std::vector<size_t> group = GroupByEdges(mesh, vertex, around);
    std::map<size_t, std::uint32_t> vertex_of_group{{0, vertex}};
    for (size_t i = 0; i < around.size(); ++i) {
      const auto [found, is_new] =
          vertex_of_group.try_emplace(group[i], static_cast<std::uint32_t>(mesh.vertices.size()));
      if (is_new) {
        mesh.vertices.push_back(Eigen::Vector3d(mesh.vertices[vertex]));
        copied.push_back(vertex);
      }
      for (std::uint32_t& corner : mesh.triangles[around[i]])
        if (corner == vertex) corner = found->second;
    }
  }
  return copied;
}

HeightMesh TriangulateHeights(const SurfaceMap& surface, double max_step, double min_belief) {
  Triangulator triangulator(surface, max_step);
  HeightMesh mesh = triangulator.Run();
  if (min_belief > 0) {
    std::vector<double> values = triangulator.beliefs();
    for (double& value : values) value -= min_belief;
    mesh = MeshCutter(mesh, std::move(values)).Cut();
  }
  DuplicateNonManifoldVertices(mesh);
  return mesh;
}

}  // namespace parkade
