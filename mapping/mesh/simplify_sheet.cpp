#include "mapping/mesh/simplify_sheet.h"

#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Bounded_normal_change_filter.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Constrained_placement.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/GarlandHeckbert_plane_policies.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>

#include <cmath>
#include <map>
#include <tuple>
#include <unordered_map>

#include "core/largest_first.h"
#include "mapping/mesh/thin_sheet.h"

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

/// Quadrics alone cost nothing on a plane, where edges would collapse in any order, and fans of
/// hundreds of triangles would form, which are ugly and slow. Short edges therefore go first.
class EvenPolicies : public Policies {
 public:
  EvenPolicies(Mesh& mesh, double max_error)
      : Policies(mesh, kBorderWeight),
        cost_per_square_meter_(max_error * max_error / (kMaxEdge * kMaxEdge)) {}

  template <typename Profile>
  boost::optional<double> operator()(const Profile& profile,
                                     const boost::optional<Kernel::Point_3>& placement) const {
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
      const auto [found, is_new] =
          in_tile.try_emplace(vertex, static_cast<std::uint32_t>(tile.in_sheet.size()));
      if (is_new) {
        tile.in_sheet.push_back(vertex);
        tile.sheet.vertices.push_back(sheet.vertices[vertex]);
      }
      triangle[i] = found->second;
    }
  }
  // The cut may leave fans that touched only beyond it.
  for (const std::uint32_t copied : SplitFans(tile.sheet))
    tile.in_sheet.push_back(tile.in_sheet[copied]);
  return tile;
}

/// Most of a tile is flat: what need not be ordered by its cost goes first.
void Thin(const Colors& colors, const std::vector<bool>& is_seam,
          const SimplifySheetOptions& options, Tile& tile) {
  Colors of_tile;
  std::vector<bool> is_kept;
  for (const std::uint32_t vertex : tile.in_sheet) {
    of_tile.push_back(colors[vertex]);
    is_kept.push_back(is_seam[vertex]);
  }
  const std::vector<std::uint32_t> left =
      ThinSheet(of_tile, is_kept, {.color_contrast = options.color_contrast}, tile.sheet);
  for (size_t i = 0; i < left.size(); ++i) tile.in_sheet[i] = tile.in_sheet[left[i]];
  tile.in_sheet.resize(left.size());
}

/// Marks the edges that must stay: seams between tiles and edges of color.
EdgeFlags MarkKept(Mesh& mesh, const Tile& tile, const Colors& colors,
                   const std::vector<bool>& is_seam, int color_contrast) {
  EdgeFlags is_kept = mesh.add_property_map<Mesh::Edge_index, bool>("e:is_kept", false).first;
  for (const Mesh::Edge_index edge : mesh.edges()) {
    const std::uint32_t a = tile.in_sheet[mesh.vertex(edge, 0)],
                        b = tile.in_sheet[mesh.vertex(edge, 1)];
    is_kept[edge] = is_seam[a] || is_seam[b] || HasContrast(colors[a], colors[b], color_contrast);
  }
  return is_kept;
}

/// A tile as it is.
SheetPiece PieceOf(const Tile& tile, const std::vector<bool>& is_seam) {
  SheetPiece piece{.sheet = tile.sheet, .seams = tile.in_sheet};
  for (std::uint32_t& vertex : piece.seams)
    if (!is_seam[vertex]) vertex = SheetPiece::kNoSeam;
  return piece;
}

SheetPiece Simplify(Tile tile, const Colors& colors, const std::vector<bool>& is_seam,
                    const SimplifySheetOptions& options) {
  Thin(colors, is_seam, options, tile);
  Mesh mesh;
  for (const Eigen::Vector3d& vertex : tile.sheet.vertices)
    mesh.add_vertex({vertex.x(), vertex.y(), vertex.z()});
  for (const auto& [a, b, c] : tile.sheet.triangles)
    if (mesh.add_face(Mesh::Vertex_index(a), Mesh::Vertex_index(b), Mesh::Vertex_index(c)) ==
        Mesh::null_face())
      return PieceOf(tile, is_seam);
  const EdgeFlags is_kept = MarkKept(mesh, tile, colors, is_seam, options.color_contrast);
  const EvenPolicies policies(mesh, options.max_error);
  const collapse::Constrained_placement<EvenPolicies, EdgeFlags> placement(is_kept, policies);
  collapse::edge_collapse(mesh, StopAtCost{options.max_error * options.max_error},
                          CGAL::parameters::edge_is_constrained_map(is_kept)
                              .get_cost(policies)
                              .get_placement(placement)
                              .filter(collapse::Bounded_normal_change_filter<>()));
  SheetPiece simplified;
  std::vector<std::uint32_t> compact(tile.in_sheet.size());
  for (const Mesh::Vertex_index vertex : mesh.vertices()) {
    const auto i = static_cast<std::uint32_t>(vertex);
    compact[i] = static_cast<std::uint32_t>(simplified.seams.size());
    const auto& point = mesh.point(vertex);
    simplified.sheet.vertices.emplace_back(point.x(), point.y(), point.z());
    simplified.seams.push_back(is_seam[tile.in_sheet[i]] ? tile.in_sheet[i] : SheetPiece::kNoSeam);
  }
  for (const Mesh::Face_index face : mesh.faces()) {
    std::array<std::uint32_t, 3>& triangle = simplified.sheet.triangles.emplace_back();
    size_t i = 0;
    for (const Mesh::Vertex_index vertex : CGAL::vertices_around_face(mesh.halfedge(face), mesh))
      triangle[i++] = compact[static_cast<std::uint32_t>(vertex)];
  }
  return simplified;
}

/// Triangles by square, in order of row and column.
using Groups = std::map<std::pair<int, int>, std::vector<std::uint32_t>>;

Groups GroupByTile(const VoxelSheet& sheet, double tile_size) {
  Groups groups;
  for (size_t t = 0; t < sheet.triangles.size(); ++t) {
    const auto& [a, b, c] = sheet.triangles[t];
    const Eigen::Vector3d center = (sheet.vertices[a] + sheet.vertices[b] + sheet.vertices[c]) / 3;
    groups[{static_cast<int>(std::floor(center.y() / tile_size)),
            static_cast<int>(std::floor(center.x() / tile_size))}]
        .push_back(static_cast<std::uint32_t>(t));
  }
  return groups;
}

/// Vertices that triangles of more than one tile use.
std::vector<bool> FindSeams(const VoxelSheet& sheet, const Groups& tiles) {
  constexpr std::uint32_t kNone = UINT32_MAX;
  std::vector<std::uint32_t> tile_of(sheet.vertices.size(), kNone);
  std::vector<bool> is_seam(sheet.vertices.size());
  std::uint32_t i = 0;
  for (const auto& [square, triangles] : tiles) {
    for (const std::uint32_t t : triangles)
      for (const std::uint32_t vertex : sheet.triangles[t]) {
        if (tile_of[vertex] != kNone && tile_of[vertex] != i) is_seam[vertex] = true;
        tile_of[vertex] = i;
      }
    ++i;
  }
  return is_seam;
}

}  // namespace

std::vector<SheetPiece> SimplifyPieces(const VoxelSheet& sheet, const Colors& colors,
                                       const SimplifySheetOptions& options,
                                       const std::optional<Eigen::AlignedBox2i>& wanted) {
  const Groups groups = GroupByTile(sheet, options.tile_size);
  const std::vector<bool> is_seam = FindSeams(sheet, groups);
  std::vector<const Groups::value_type*> tiles;
  for (const auto& group : groups) {
    const Eigen::Array2i at(group.first.second, group.first.first);
    if (!wanted || ((at >= wanted->min().array()).all() && (at < wanted->max().array()).all()))
      tiles.push_back(&group);
  }
  const auto num_triangles = [&](size_t i) { return tiles[i]->second.size(); };
  return ParallelMapLargestFirst(tiles.size(), num_triangles, [&](size_t i) {
    SheetPiece piece = Simplify(CutTile(sheet, tiles[i]->second), colors, is_seam, options);
    std::tie(piece.row, piece.column) = tiles[i]->first;
    return piece;
  });
}

std::vector<std::vector<std::uint32_t>> JoinPieces(std::span<const SheetPiece> pieces,
                                                   VoxelSheet& joined) {
  std::vector<std::vector<std::uint32_t>> in_joined(pieces.size());
  std::unordered_map<std::uint32_t, std::uint32_t> seam_vertices;  // of the whole -> of the result
  for (size_t p = 0; p < pieces.size(); ++p) {
    const SheetPiece& piece = pieces[p];
    for (size_t i = 0; i < piece.seams.size(); ++i) {
      const auto next = static_cast<std::uint32_t>(joined.vertices.size());
      const bool is_shared = piece.seams[i] != SheetPiece::kNoSeam;
      in_joined[p].push_back(
          is_shared ? seam_vertices.try_emplace(piece.seams[i], next).first->second : next);
      if (in_joined[p][i] == next) joined.vertices.push_back(piece.sheet.vertices[i]);
    }
    for (const auto& [a, b, c] : piece.sheet.triangles)
      joined.triangles.push_back({in_joined[p][a], in_joined[p][b], in_joined[p][c]});
  }
  return in_joined;
}

VoxelSheet SimplifySheet(const VoxelSheet& sheet, const Colors& colors,
                         const SimplifySheetOptions& options) {
  VoxelSheet joined;
  JoinPieces(SimplifyPieces(sheet, colors, options), joined);
  return joined;
}

}  // namespace parkade
