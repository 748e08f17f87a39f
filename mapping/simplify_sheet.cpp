#include "mapping/simplify_sheet.h"

#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Bounded_normal_change_filter.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Constrained_placement.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/GarlandHeckbert_plane_policies.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>

#include <cmath>
#include <cstdlib>

#include "core/parallel.h"

namespace parkade {
namespace {

namespace collapse = CGAL::Surface_mesh_simplification;

using Kernel = CGAL::Simple_cartesian<double>;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Policies = collapse::GarlandHeckbert_plane_policies<Mesh, Kernel>;
using EdgeFlags = Mesh::Property_map<Mesh::Edge_index, bool>;
using Colors = std::vector<std::array<std::uint8_t, 3>>;

constexpr double kMaxEdge = 3.0;       // [m] about the longest edge on a plane
constexpr double kBorderWeight = 2.0;  // of a border's quadrics: an outline moves less than a plane

/// Quadrics alone cost nothing on a plane, where edges would collapse in any order, and fans of hundreds of triangles
/// would form, which are ugly and slow. Short edges therefore go first.
class EvenPolicies : public Policies {
 public:
  EvenPolicies(Mesh& mesh, double max_error)
      : Policies(mesh, kBorderWeight), cost_per_square_meter_(max_error * max_error / (kMaxEdge * kMaxEdge)) {}

  template <typename Profile>
  boost::optional<double> operator()(const Profile& profile, const boost::optional<Kernel::Point_3>& placement) const {
    boost::optional<double> cost = Policies::operator()(profile, placement);
    if (cost) *cost += cost_per_square_meter_ * CGAL::squared_distance(profile.p0(), profile.p1());
    return cost;
  }

  template <typename Profile>
  boost::optional<Kernel::Point_3> operator()(const Profile& profile) const {
    return Policies::operator()(profile);
  }

 private:
  double cost_per_square_meter_;
};

/// Ends the collapse at a bound of the cost: a sum of squared distances to planes.
struct StopAtCost {
  double max_cost = 0;

  template <typename Cost, typename Profile>
  bool operator()(const Cost& cost, const Profile&, std::size_t, std::size_t) const {
    return static_cast<double>(cost) > max_cost;
  }
};

/// The triangles of one square of the sheet. Vertex i is vertex `in_sheet[i]` of the whole.
struct Tile {
  VoxelSheet sheet;
  std::vector<std::uint32_t> in_sheet;
};

Tile CutTile(const VoxelSheet& sheet, const std::vector<std::uint32_t>& triangles) {
  Tile tile;
  std::unordered_map<std::uint32_t, std::uint32_t> in_tile;
  for (const std::uint32_t t : triangles) {
    std::array<std::uint32_t, 3>& triangle = tile.sheet.triangles.emplace_back();
    for (size_t i = 0; i < 3; ++i) {
      const std::uint32_t vertex = sheet.triangles[t][i];
      const auto [found, is_new] = in_tile.try_emplace(vertex, static_cast<std::uint32_t>(tile.in_sheet.size()));
      if (is_new) {
        tile.in_sheet.push_back(vertex);
        tile.sheet.vertices.push_back(sheet.vertices[vertex]);
      }
      triangle[i] = found->second;
    }
  }
  // The cut may leave fans that touched only beyond it.
  for (const std::uint32_t copied : SplitFans(tile.sheet)) tile.in_sheet.push_back(tile.in_sheet[copied]);
  return tile;
}

bool HasContrast(const std::array<std::uint8_t, 3>& a, const std::array<std::uint8_t, 3>& b, int contrast) {
  for (size_t c = 0; c < 3; ++c)
    if (std::abs(int{a[c]} - int{b[c]}) > contrast) return true;
  return false;
}

/// Marks the edges that must stay: seams between tiles and edges of colour.
EdgeFlags MarkKept(Mesh& mesh, const Tile& tile, const Colors& colors, const std::vector<bool>& is_seam,
                   int color_contrast) {
  EdgeFlags is_kept = mesh.add_property_map<Mesh::Edge_index, bool>("e:is_kept", false).first;
  for (const Mesh::Edge_index edge : mesh.edges()) {
    const std::uint32_t a = tile.in_sheet[mesh.vertex(edge, 0)], b = tile.in_sheet[mesh.vertex(edge, 1)];
    is_kept[edge] = is_seam[a] || is_seam[b] || HasContrast(colors[a], colors[b], color_contrast);
  }
  return is_kept;
}

/// A simplified tile: `in_sheet` has kNew for vertices that moved.
constexpr std::uint32_t kNew = UINT32_MAX;

Tile Simplify(const Tile& tile, const Colors& colors, const std::vector<bool>& is_seam,
              const SimplifySheetOptions& options) {
  Mesh mesh;
  for (const Eigen::Vector3d& vertex : tile.sheet.vertices) mesh.add_vertex({vertex.x(), vertex.y(), vertex.z()});
  for (const auto& [a, b, c] : tile.sheet.triangles)
    if (mesh.add_face(Mesh::Vertex_index(a), Mesh::Vertex_index(b), Mesh::Vertex_index(c)) == Mesh::null_face())
      return tile;
  const EdgeFlags is_kept = MarkKept(mesh, tile, colors, is_seam, options.color_contrast);
  const EvenPolicies policies(mesh, options.max_error);
  const collapse::Constrained_placement<EvenPolicies, EdgeFlags> placement(is_kept, policies);
  collapse::edge_collapse(
      mesh, StopAtCost{options.max_error * options.max_error},
      CGAL::parameters::edge_is_constrained_map(is_kept).get_cost(policies).get_placement(placement).filter(
          collapse::Bounded_normal_change_filter<>()));
  Tile simplified;
  std::vector<std::uint32_t> compact(tile.in_sheet.size(), kNew);
  for (const Mesh::Vertex_index vertex : mesh.vertices()) {
    const auto i = static_cast<std::uint32_t>(vertex);
    compact[i] = static_cast<std::uint32_t>(simplified.in_sheet.size());
    const auto& point = mesh.point(vertex);
    simplified.sheet.vertices.emplace_back(point.x(), point.y(), point.z());
    simplified.in_sheet.push_back(is_seam[tile.in_sheet[i]] ? tile.in_sheet[i] : kNew);
  }
  for (const Mesh::Face_index face : mesh.faces()) {
    std::array<std::uint32_t, 3>& triangle = simplified.sheet.triangles.emplace_back();
    size_t i = 0;
    for (const Mesh::Vertex_index vertex : CGAL::vertices_around_face(mesh.halfedge(face), mesh))
      triangle[i++] = compact[static_cast<std::uint32_t>(vertex)];
  }
  return simplified;
}

/// Triangles by tile, in order of tiles.
std::vector<std::vector<std::uint32_t>> GroupByTile(const VoxelSheet& sheet, double tile_size) {
  std::map<std::pair<int, int>, std::vector<std::uint32_t>> groups;
  for (size_t t = 0; t < sheet.triangles.size(); ++t) {
    const auto& [a, b, c] = sheet.triangles[t];
    const Eigen::Vector3d center = (sheet.vertices[a] + sheet.vertices[b] + sheet.vertices[c]) / 3;
    groups[{static_cast<int>(std::floor(center.y() / tile_size)), static_cast<int>(std::floor(center.x() / tile_size))}]
        .push_back(static_cast<std::uint32_t>(t));
  }
  std::vector<std::vector<std::uint32_t>> result;
  for (auto& [square, triangles] : groups) result.push_back(std::move(triangles));
  return result;
}

/// Vertices that triangles of more than one tile use.
std::vector<bool> FindSeams(const VoxelSheet& sheet, const std::vector<std::vector<std::uint32_t>>& tiles) {
  std::vector<std::uint32_t> tile_of(sheet.vertices.size(), kNew);
  std::vector<bool> is_seam(sheet.vertices.size());
  for (std::uint32_t i = 0; i < tiles.size(); ++i)
    for (const std::uint32_t t : tiles[i])
      for (const std::uint32_t vertex : sheet.triangles[t]) {
        if (tile_of[vertex] != kNew && tile_of[vertex] != i) is_seam[vertex] = true;
        tile_of[vertex] = i;
      }
  return is_seam;
}

}  // namespace

VoxelSheet SimplifySheet(const VoxelSheet& sheet, const Colors& colors, const SimplifySheetOptions& options) {
  const auto groups = GroupByTile(sheet, options.tile_size);
  const std::vector<bool> is_seam = FindSeams(sheet, groups);
  const std::vector<Tile> tiles = ParallelMap(
      groups.size(), [&](size_t i) { return Simplify(CutTile(sheet, groups[i]), colors, is_seam, options); });

  VoxelSheet result;
  std::unordered_map<std::uint32_t, std::uint32_t> seam_vertices;  // of the sheet -> of the result
  for (const Tile& tile : tiles) {
    std::vector<std::uint32_t> in_result(tile.in_sheet.size());
    for (size_t i = 0; i < in_result.size(); ++i) {
      const auto next = static_cast<std::uint32_t>(result.vertices.size());
      const bool is_shared = tile.in_sheet[i] != kNew && is_seam[tile.in_sheet[i]];
      in_result[i] = is_shared ? seam_vertices.try_emplace(tile.in_sheet[i], next).first->second : next;
      if (in_result[i] == next) result.vertices.push_back(tile.sheet.vertices[i]);
    }
    for (const auto& [a, b, c] : tile.sheet.triangles)
      result.triangles.push_back({in_result[a], in_result[b], in_result[c]});
  }
  return result;
}

}  // namespace parkade
