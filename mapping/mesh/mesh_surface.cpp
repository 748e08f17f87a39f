#include "mapping/mesh/mesh_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <tuple>

#include "core/log.h"
#include "core/parallel.h"
#include "mapping/ground/largest_first.h"
#include "mapping/mesh/mesh_window.h"

namespace parkade {
namespace {

/// [m] a whole-meter point amid the vertices, so that float coordinates stay small.
Eigen::Vector3d OriginOf(const std::vector<Eigen::Vector3d>& vertices) {
  if (vertices.empty()) return Eigen::Vector3d::Zero();
  Eigen::Vector3d low = vertices.front(), high = vertices.front();
  for (const Eigen::Vector3d& vertex : vertices) {
    low = low.cwiseMin(vertex);
    high = high.cwiseMax(vertex);
  }
  return (0.5 * (low + high)).array().round().matrix();
}

/// Area-weighted, unit, upwards.
std::vector<Eigen::Vector3f> NormalsOf(const HeightMesh& mesh) {
  std::vector<Eigen::Vector3d> sums(mesh.vertices.size(), Eigen::Vector3d::Zero());
  for (const auto& [a, b, c] : mesh.triangles) {
    const Eigen::Vector3d normal =
        (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]);
    for (const std::uint32_t vertex : {a, b, c}) sums[vertex] += normal;
  }
  std::vector<Eigen::Vector3f> normals;
  normals.reserve(sums.size());
  for (const Eigen::Vector3d& sum : sums)
    normals.push_back(sum.norm() > 1e-12 ? Eigen::Vector3f(sum.normalized().cast<float>())
                                         : Eigen::Vector3f::UnitZ());
  return normals;
}

/// The pieces of all windows, by row, then column.
std::vector<MeshPiece> MeshPieces(const SurfaceMap& surface, const MeshOptions& options,
                                  size_t& num_full_triangles) {
  std::vector<MeshPiece> pieces;
  SeamNumbers numbers;
  const auto add = [&](WindowMesh&& mesh) {
    numbers.Renumber(mesh.height_mesh, mesh.pieces);
    std::move(mesh.pieces.begin(), mesh.pieces.end(), std::back_inserter(pieces));
    num_full_triangles += mesh.num_full_triangles;
  };
  if (!options.simplify) {
    add(MeshWithoutSimplifying(surface, options));
    return pieces;
  }
  const std::vector<MeshWindow> windows = CutIntoWindows(surface, options);
  // Many windows go side by side; of few, each one's tiles.
  const auto num_threads = static_cast<size_t>(NumThreads());
  const size_t num_at_once = windows.size() < 2 * num_threads ? 1 : 4 * num_threads;
  for (size_t begin = 0; begin < windows.size(); begin += num_at_once) {
    if (num_at_once == 1) {
      add(MeshWindowOf(surface, windows[begin], options));
    } else {
      const size_t count = std::min(num_at_once, windows.size() - begin);
      const auto num_cells = [&](size_t i) { return windows[begin + i].num_cells; };
      const auto mesh_of = [&](size_t i) {
        return MeshWindowOf(surface, windows[begin + i], options);
      };
      for (WindowMesh& mesh : ParallelMapLargestFirst(count, num_cells, mesh_of))
        add(std::move(mesh));
    }
    ReleaseMemory(surface.cells);
  }
  std::sort(pieces.begin(), pieces.end(), [](const MeshPiece& a, const MeshPiece& b) {
    return std::tie(a.simplified.row, a.simplified.column) <
           std::tie(b.simplified.row, b.simplified.column);
  });
  return pieces;
}

/// The meshes of the pieces, which are gone then, as one. -> for each piece where its vertices are
/// in there
std::vector<std::vector<std::uint32_t>> JoinAll(std::vector<MeshPiece>& pieces,
                                                HeightMesh& joined) {
  std::vector<SimplifiedPiece> simplified;
  simplified.reserve(pieces.size());
  for (MeshPiece& piece : pieces) simplified.push_back(std::move(piece.simplified));
  return JoinPieces(simplified, joined);
}

}  // namespace

TriangleMesh MeshSurface(const SurfaceMap& surface, const MeshOptions& options) {
  options.Validate();
  size_t num_full_triangles = 0;
  std::vector<MeshPiece> pieces = MeshPieces(surface, options, num_full_triangles);
  HeightMesh joined;
  const std::vector<std::vector<std::uint32_t>> in_joined = JoinAll(pieces, joined);

  TriangleMesh mesh;
  mesh.origin = OriginOf(joined.vertices);
  mesh.normals = NormalsOf(joined);
  mesh.triangles = std::move(joined.triangles);
  mesh.vertices.reserve(joined.vertices.size());
  for (const Eigen::Vector3d& vertex : joined.vertices)
    mesh.vertices.push_back((vertex - mesh.origin).cast<float>());
  mesh.colors.resize(joined.vertices.size());
  mesh.height_sigmas.resize(joined.vertices.size());
  mesh.surfaces.resize(joined.vertices.size(), SurfaceClass::kUnknown);
  for (size_t p = 0; p < pieces.size(); ++p)
    for (size_t i = 0; i < in_joined[p].size(); ++i) {
      mesh.colors[in_joined[p][i]] = pieces[p].colors[i];
      mesh.height_sigmas[in_joined[p][i]] = pieces[p].height_sigmas[i];
      mesh.surfaces[in_joined[p][i]] = pieces[p].surfaces[i];
    }
  ValidateMesh(mesh);
  LogInfo("stage=mesh_surface triangles=" + std::to_string(mesh.triangles.size()) +
          " before_simplifying=" + std::to_string(num_full_triangles));
  return mesh;
}

}  // namespace parkade
