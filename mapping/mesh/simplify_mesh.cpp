#include "mapping/mesh/simplify_mesh.h"

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

#include "mapping/ground/largest_first.h"
#include "mapping/mesh/decimate_flat.h"

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

/// Quadrics alone cost nothing on a plane, where edges would collapse in any order, and
/// hundreds of triangles would meet at one vertex, which are ugly and slow. Short edges therefore
/// go first.
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

/// The triangles of one square of the mesh. Vertex i is vertex `in_mesh[i]` of the whole.
struct Tile {
  HeightMesh mesh;
  std::vector<std::uint32_t> in_mesh;
};

Tile CutTile(const HeightMesh& mesh, const std::vector<std::uint32_t>& triangles) {
  Tile tile;
  std::unordered_map<std::uint32_t, std::uint32_t> in_tile;
  for (const std::uint32_t t : triangles) {
    std::array<std::uint32_t, 3>& triangle = tile.mesh.triangles.emplace_back();
    for (size_t i = 0; i < 3; ++i) {
      const std::uint32_t vertex = mesh.triangles[t][i];
      const auto [found, is_new] =
          in_tile.try_emplace(vertex, static_cast<std::uint32_t>(tile.in_mesh.size()));
      if (is_new) {
        tile.in_mesh.push_back(vertex);
        tile.mesh.vertices.push_back(mesh.vertices[vertex]);
      }
      triangle[i] = found->second;
    }
  }
  // The cut may leave vertices that were one group of triangles only with what lies beyond it.
  for (const std::uint32_t copied : DuplicateNonManifoldVertices(tile.mesh))
    tile.in_mesh.push_back(tile.in_mesh[copied]);
  return tile;
}

/// Most of a tile is flat: what need not be ordered by its cost goes first.
void Decimate(const Colors& colors, const std::vector<bool>& is_seam,
              const SimplifyMeshOptions& options, Tile& tile) {
  Colors of_tile;
  std::vector<bool> is_kept;
  for (const std::uint32_t vertex : tile.in_mesh) {
    of_tile.push_back(colors[vertex]);
    is_kept.push_back(is_seam[vertex]);
  }
  const std::vector<std::uint32_t> left =
      DecimateFlat(of_tile, is_kept, {.color_contrast = options.color_contrast}, tile.mesh);
  for (size_t i = 0; i < left.size(); ++i) tile.in_mesh[i] = tile.in_mesh[left[i]];
  tile.in_mesh.resize(left.size());
}

/// Marks the edges that must stay: seams between tiles and edges of color.
EdgeFlags MarkKept(Mesh& mesh, const Tile& tile, const Colors& colors,
                   const std::vector<bool>& is_seam, int color_contrast) {
  EdgeFlags is_kept = mesh.add_property_map<Mesh::Edge_index, bool>("e:is_kept", false).first;
  for (const Mesh::Edge_index edge : mesh.edges()) {
    const std::uint32_t a = tile.in_mesh[mesh.vertex(edge, 0)],
                        b = tile.in_mesh[mesh.vertex(edge, 1)];
    is_kept[edge] = is_seam[a] || is_seam[b] || HasContrast(colors[a], colors[b], color_contrast);
  }
  return is_kept;
}

/// A tile as it is.
SimplifiedPiece PieceOf(const Tile& tile, const std::vector<bool>& is_seam) {
  SimplifiedPiece piece{.mesh = tile.mesh, .seams = tile.in_mesh};
  for (std::uint32_t& vertex : piece.seams)
    if (!is_seam[vertex]) vertex = SimplifiedPiece::kNoSeam;
  return piece;
}

SimplifiedPiece Simplify(Tile tile, const Colors& colors, const std::vector<bool>& is_seam,
                         const SimplifyMeshOptions& options) {
  Decimate(colors, is_seam, options, tile);
  Mesh mesh;
  for (const Eigen::Vector3d& vertex : tile.mesh.vertices)
    mesh.add_vertex({vertex.x(), vertex.y(), vertex.z()});
  for (const auto& [a, b, c] : tile.mesh.triangles)
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
  SimplifiedPiece simplified;
  std::vector<std::uint32_t> compact(tile.in_mesh.size());
  for (const Mesh::Vertex_index vertex : mesh.vertices()) {
    const auto i = static_cast<std::uint32_t>(vertex);
    compact[i] = static_cast<std::uint32_t>(simplified.seams.size());
    const auto& point = mesh.point(vertex);
    simplified.mesh.vertices.emplace_back(point.x(), point.y(), point.z());
    simplified.seams.push_back(is_seam[tile.in_mesh[i]] ? tile.in_mesh[i]
                                                        : SimplifiedPiece::kNoSeam);
  }
  for (const Mesh::Face_index face : mesh.faces()) {
    std::array<std::uint32_t, 3>& triangle = simplified.mesh.triangles.emplace_back();
    size_t i = 0;
    for (const Mesh::Vertex_index vertex : CGAL::vertices_around_face(mesh.halfedge(face), mesh))
      triangle[i++] = compact[static_cast<std::uint32_t>(vertex)];
  }
  return simplified;
}

/// Triangles by square, in order of row and column.
using Groups = std::map<std::pair<int, int>, std::vector<std::uint32_t>>;

Groups GroupByTile(const HeightMesh& mesh, double tile_size) {
  Groups groups;
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    const Eigen::Vector3d center = (mesh.vertices[a] + mesh.vertices[b] + mesh.vertices[c]) / 3;
    groups[{static_cast<int>(std::floor(center.y() / tile_size)),
            static_cast<int>(std::floor(center.x() / tile_size))}]
        .push_back(static_cast<std::uint32_t>(t));
  }
  return groups;
}

/// Vertices that triangles of more than one tile use.
std::vector<bool> FindSeams(const HeightMesh& mesh, const Groups& tiles) {
  constexpr std::uint32_t kNone = UINT32_MAX;
  std::vector<std::uint32_t> tile_of(mesh.vertices.size(), kNone);
  std::vector<bool> is_seam(mesh.vertices.size());
  std::uint32_t i = 0;
  for (const auto& [square, triangles] : tiles) {
    for (const std::uint32_t t : triangles)
      for (const std::uint32_t vertex : mesh.triangles[t]) {
        if (tile_of[vertex] != kNone && tile_of[vertex] != i) is_seam[vertex] = true;
        tile_of[vertex] = i;
      }
    ++i;
  }
  return is_seam;
}

}  // namespace

std::vector<SimplifiedPiece> SimplifyPieces(const HeightMesh& mesh, const Colors& colors,
                                            const SimplifyMeshOptions& options,
                                            const std::optional<Eigen::AlignedBox2i>& wanted) {
  const Groups groups = GroupByTile(mesh, options.tile_size);
  const std::vector<bool> is_seam = FindSeams(mesh, groups);
  std::vector<const Groups::value_type*> tiles;
  for (const auto& group : groups) {
    const Eigen::Array2i at(group.first.second, group.first.first);
    if (!wanted || ((at >= wanted->min().array()).all() && (at < wanted->max().array()).all()))
      tiles.push_back(&group);
  }
  const auto num_triangles = [&](size_t i) { return tiles[i]->second.size(); };
  return ParallelMapLargestFirst(tiles.size(), num_triangles, [&](size_t i) {
    SimplifiedPiece piece = Simplify(CutTile(mesh, tiles[i]->second), colors, is_seam, options);
    std::tie(piece.row, piece.column) = tiles[i]->first;
    return piece;
  });
}

std::vector<std::vector<std::uint32_t>> JoinPieces(std::span<const SimplifiedPiece> pieces,
                                                   HeightMesh& joined) {
  std::vector<std::vector<std::uint32_t>> in_joined(pieces.size());
  std::unordered_map<std::uint32_t, std::uint32_t> seam_vertices;  // of the whole -> of the result
  for (size_t p = 0; p < pieces.size(); ++p) {
    const SimplifiedPiece& piece = pieces[p];
    for (size_t i = 0; i < piece.seams.size(); ++i) {
      const auto next = static_cast<std::uint32_t>(joined.vertices.size());
      const bool is_shared = piece.seams[i] != SimplifiedPiece::kNoSeam;
      in_joined[p].push_back(
          is_shared ? seam_vertices.try_emplace(piece.seams[i], next).first->second : next);
      if (in_joined[p][i] == next) joined.vertices.push_back(piece.mesh.vertices[i]);
    }
    for (const auto& [a, b, c] : piece.mesh.triangles)
      joined.triangles.push_back({in_joined[p][a], in_joined[p][b], in_joined[p][c]});
  }
  return in_joined;
}

}  // namespace parkade
