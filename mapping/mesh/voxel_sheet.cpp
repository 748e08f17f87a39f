#include "mapping/mesh/voxel_sheet.h"

#include <cmath>
#include <numeric>
#include <span>
#include <unordered_map>

#include "mapping/ground/surface_links.h"
#include "mapping/mesh/marching_cubes.h"

namespace parkade {
namespace {

constexpr double kMinClearance =
    1e-4;  // [m] of a cell's height to a layer of voxel corners: no slivers of no width

class SheetExtractor {
 public:
  SheetExtractor(const SurfaceMap& surface, double voxel_height, double max_step)
      : surface_(surface), links_(LinkCells(surface, max_step)), voxel_height_(voxel_height) {
    heights_.reserve(surface.cells.size());
    for (const SurfaceCell& cell : surface.cells)
      heights_.push_back(KeepClear(static_cast<double>(cell.height)));
    column_vertices_.assign(surface.cells.size(), kNone);
  }

  /// One entry per vertex of the sheet.
  const std::vector<double>& beliefs() const { return beliefs_; }

  VoxelSheet Extract() {
    for (size_t i = 0; i < surface_.cells.size(); ++i) {
      const int right = links_.right[i], up = links_.up[i];
      if (right < 0 || up < 0) continue;
      const int diagonal = links_.up[static_cast<size_t>(right)];
      if (diagonal < 0 || diagonal != links_.right[static_cast<size_t>(up)]) continue;
      MarchColumn({static_cast<int>(i), right, up, diagonal});
    }
    return std::move(sheet_);
  }

 private:
  static constexpr std::uint32_t kNone = UINT32_MAX;

  /// Layers lie at (k + 1/2) voxel heights: a lot at height 0 stays clear of them.
  double LayerHeight(int layer) const { return (layer + 0.5) * voxel_height_; }
  int LayerBelow(double height) const {
    return static_cast<int>(std::floor(height / voxel_height_ - 0.5));
  }

  double KeepClear(double height) const {
    for (const int layer : {LayerBelow(height), LayerBelow(height) + 1}) {
      const double above = height - LayerHeight(layer);
      if (std::abs(above) < kMinClearance)
        return LayerHeight(layer) + (above < 0 ? -kMinClearance : kMinClearance);
    }
    return height;
  }

  /// All voxels between four cells through which the ground passes.
  void MarchColumn(const std::array<int, 4>& cells) {
    std::array<double, 4> heights;
    for (size_t k = 0; k < 4; ++k) heights[k] = heights_[static_cast<size_t>(cells[k])];
    const auto [lowest, highest] = std::minmax_element(heights.begin(), heights.end());
    for (int layer = LayerBelow(*lowest); layer <= LayerBelow(*highest); ++layer) {
      int inside_bits = 0;
      for (int corner = 0; corner < 8; ++corner)
        if (LayerHeight(layer + corner / 4) < heights[static_cast<size_t>(corner % 4)])
          inside_bits |= 1 << corner;
      for (const auto& edges : MarchingCubesCases()[static_cast<size_t>(inside_bits)]) {
        std::array<std::uint32_t, 3> triangle;
        for (size_t i = 0; i < 3; ++i) triangle[i] = VertexOn(edges[i], cells, layer);
        sheet_.triangles.push_back(triangle);
      }
    }
  }

  std::uint32_t VertexOn(const VoxelEdge& edge, const std::array<int, 4>& cells, int layer) {
    const int a = cells[edge.a % 4], b = cells[edge.b % 4];
    if (a == b) return ColumnVertex(a);
    return LayerVertex(a, b, layer + edge.a / 4);
  }

  Eigen::Vector3d CenterOf(int cell) const {
    const SurfaceCell& c = surface_.cells[static_cast<size_t>(cell)];
    return {(c.x + 0.5) * surface_.cell_size, (c.y + 0.5) * surface_.cell_size,
            heights_[static_cast<size_t>(cell)]};
  }

  std::uint32_t ColumnVertex(int cell) {
    std::uint32_t& vertex = column_vertices_[static_cast<size_t>(cell)];
    if (vertex == kNone) vertex = AddVertex(CenterOf(cell), BeliefOf(cell));
    return vertex;
  }

  std::uint32_t LayerVertex(int a, int b, int layer) {
    // Linked cells climb by one step, so that a pair and a layer name one edge.
    const bool is_along_x = links_.right[static_cast<size_t>(a)] == b;
    const std::uint64_t key = (static_cast<std::uint64_t>(a) << 33) |
                              (std::uint64_t{is_along_x} << 32) | static_cast<std::uint32_t>(layer);
    const auto [found, is_new] = layer_vertices_.try_emplace(key, 0);
    if (is_new) {
      const Eigen::Vector3d from = CenterOf(a), to = CenterOf(b);
      const double fraction = (LayerHeight(layer) - from.z()) / (to.z() - from.z());
      found->second = AddVertex(from + fraction * (to - from),
                                BeliefOf(a) + fraction * (BeliefOf(b) - BeliefOf(a)));
    }
    return found->second;
  }

  double BeliefOf(int cell) const {
    return static_cast<double>(surface_.cells[static_cast<size_t>(cell)].free_belief);
  }

  std::uint32_t AddVertex(const Eigen::Vector3d& vertex, double belief) {
    sheet_.vertices.push_back(vertex);
    beliefs_.push_back(belief);
    return static_cast<std::uint32_t>(sheet_.vertices.size() - 1);
  }

  const SurfaceMap& surface_;
  SurfaceLinks links_;
  double voxel_height_;
  std::vector<double> heights_;
  std::vector<std::uint32_t> column_vertices_;
  std::unordered_map<std::uint64_t, std::uint32_t> layer_vertices_;
  VoxelSheet sheet_;
  std::vector<double> beliefs_;
};

/// Cuts a sheet where values on its vertices, linear in between, pass zero; what is negative goes.
/// Edges are cut not nearer to their ends than kMinCut of their length: no slivers.
class SheetCutter {
 public:
  SheetCutter(const VoxelSheet& sheet, std::vector<double> values)
      : sheet_(sheet), values_(std::move(values)) {
    kept_.assign(sheet.vertices.size(), kNone);
  }

  VoxelSheet Cut() {
    for (const auto& triangle : sheet_.triangles) {
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
    if (kept_[vertex] == kNone) kept_[vertex] = Add(sheet_.vertices[vertex]);
    return kept_[vertex];
  }

  std::uint32_t CutEdge(std::uint32_t a, std::uint32_t b) {
    if (a > b) std::swap(a, b);
    const auto [found, is_new] = cuts_.try_emplace((std::uint64_t{a} << 32) | b, 0);
    if (is_new) {
      const double fraction =
          std::clamp(values_[a] / (values_[a] - values_[b]), kMinCut, 1 - kMinCut);
      found->second =
          Add(sheet_.vertices[a] + fraction * (sheet_.vertices[b] - sheet_.vertices[a]));
    }
    return found->second;
  }

  const VoxelSheet& sheet_;
  std::vector<double> values_;
  std::vector<std::uint32_t> kept_;
  std::unordered_map<std::uint64_t, std::uint32_t> cuts_;
  VoxelSheet result_;
};

/// Triangles of one vertex grouped into fans: for each triangle the number of the first in its fan.
std::vector<size_t> GroupFans(const VoxelSheet& sheet, std::uint32_t vertex,
                              std::span<const std::uint32_t> around) {
  const auto share_spoke = [&](std::uint32_t s, std::uint32_t t) {
    for (const std::uint32_t p : sheet.triangles[s])
      for (const std::uint32_t q : sheet.triangles[t])
        if (p == q && p != vertex) return true;
    return false;
  };
  std::vector<size_t> fan(around.size());
  std::iota(fan.begin(), fan.end(), size_t{0});
  // Few triangles meet at a vertex: comparing all pairs until nothing changes is quick.
  for (bool has_changed = true; has_changed;) {
    has_changed = false;
    for (size_t i = 0; i < around.size(); ++i)
      for (size_t k = i + 1; k < around.size(); ++k)
        if (fan[i] != fan[k] && share_spoke(around[i], around[k])) {
          fan[i] = fan[k] = std::min(fan[i], fan[k]);
          has_changed = true;
        }
  }
  return fan;
}

/// True when the triangles around a vertex are one fan: n triangles have n (closed) or n + 1 (open)
/// spokes.
bool IsOneFan(const VoxelSheet& sheet, std::uint32_t vertex, std::span<const std::uint32_t> around,
              std::vector<std::uint32_t>& spokes) {
  spokes.clear();
  for (const std::uint32_t triangle : around)
    for (const std::uint32_t corner : sheet.triangles[triangle])
      if (corner != vertex) spokes.push_back(corner);
  std::sort(spokes.begin(), spokes.end());
  const auto num_spokes = std::unique(spokes.begin(), spokes.end()) - spokes.begin();
  return num_spokes <= static_cast<std::ptrdiff_t>(around.size()) + 1;
}

}  // namespace

std::vector<std::uint32_t> SplitFans(VoxelSheet& sheet) {
  // Triangles of vertex v: around_all[begin[v]] .. around_all[begin[v + 1]].
  std::vector<size_t> begin(sheet.vertices.size() + 1);
  for (const auto& triangle : sheet.triangles)
    for (const std::uint32_t vertex : triangle) ++begin[vertex + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<std::uint32_t> around_all(begin.back());
  std::vector<size_t> next = begin;
  for (size_t t = 0; t < sheet.triangles.size(); ++t)
    for (const std::uint32_t vertex : sheet.triangles[t])
      around_all[next[vertex]++] = static_cast<std::uint32_t>(t);

  std::vector<std::uint32_t> copied, spokes;
  for (std::uint32_t vertex = 0; vertex + 1 < begin.size(); ++vertex) {
    const std::span<const std::uint32_t> around(around_all.data() + begin[vertex],
                                                begin[vertex + 1] - begin[vertex]);
    if (IsOneFan(sheet, vertex, around, spokes)) continue;
    const std::vector<size_t> fan = GroupFans(sheet, vertex, around);
    std::map<size_t, std::uint32_t> vertex_of_fan{{0, vertex}};
    for (size_t i = 0; i < around.size(); ++i) {
      const auto [found, is_new] =
          vertex_of_fan.try_emplace(fan[i], static_cast<std::uint32_t>(sheet.vertices.size()));
      if (is_new) {
        sheet.vertices.push_back(Eigen::Vector3d(sheet.vertices[vertex]));
        copied.push_back(vertex);
      }
      for (std::uint32_t& corner : sheet.triangles[around[i]])
        if (corner == vertex) corner = found->second;
    }
  }
  return copied;
}

VoxelSheet ExtractSheet(const SurfaceMap& surface, double voxel_height, double max_step,
                        double min_belief) {
  SheetExtractor extractor(surface, voxel_height, max_step);
  VoxelSheet sheet = extractor.Extract();
  if (min_belief > 0) {
    std::vector<double> values = extractor.beliefs();
    for (double& value : values) value -= min_belief;
    sheet = SheetCutter(sheet, std::move(values)).Cut();
  }
  SplitFans(sheet);
  return sheet;
}

}  // namespace parkade
