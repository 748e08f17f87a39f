#include "mapping/mesh/mesh_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <tuple>

#include "core/largest_first.h"
#include "core/log.h"
#include "core/parallel.h"
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
std::vector<Eigen::Vector3f> NormalsOf(const VoxelSheet& sheet) {
  std::vector<Eigen::Vector3d> sums(sheet.vertices.size(), Eigen::Vector3d::Zero());
  for (const auto& [a, b, c] : sheet.triangles) {
    const Eigen::Vector3d normal =
        (sheet.vertices[b] - sheet.vertices[a]).cross(sheet.vertices[c] - sheet.vertices[a]);
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
    numbers.Renumber(mesh.sheet, mesh.pieces);
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
    return std::tie(a.sheet.row, a.sheet.column) < std::tie(b.sheet.row, b.sheet.column);
  });
  return pieces;
}

/// The sheets of the pieces, which are gone then, as one. -> for each piece where its vertices are
/// in there
std::vector<std::vector<std::uint32_t>> JoinSheets(std::vector<MeshPiece>& pieces,
                                                   VoxelSheet& sheet) {
  std::vector<SheetPiece> sheets;
  for (MeshPiece& piece : pieces) sheets.push_back(std::move(piece.sheet));
  return JoinPieces(sheets, sheet);
}

}  // namespace

TriangleMesh MeshSurface(const SurfaceMap& surface, const MeshOptions& options) {
  options.Validate();
  size_t num_full_triangles = 0;
  std::vector<MeshPiece> pieces = MeshPieces(surface, options, num_full_triangles);
  VoxelSheet sheet;
  const std::vector<std::vector<std::uint32_t>> in_sheet = JoinSheets(pieces, sheet);

  TriangleMesh mesh;
  mesh.origin = OriginOf(sheet.vertices);
  mesh.normals = NormalsOf(sheet);
  mesh.triangles = std::move(sheet.triangles);
  mesh.vertices.reserve(sheet.vertices.size());
  for (const Eigen::Vector3d& vertex : sheet.vertices)
    mesh.vertices.push_back((vertex - mesh.origin).cast<float>());
  mesh.colors.resize(sheet.vertices.size());
  mesh.height_sigmas.resize(sheet.vertices.size());
  for (size_t p = 0; p < pieces.size(); ++p)
    for (size_t i = 0; i < in_sheet[p].size(); ++i) {
      mesh.colors[in_sheet[p][i]] = pieces[p].colors[i];
      mesh.height_sigmas[in_sheet[p][i]] = pieces[p].height_sigmas[i];
    }
  ValidateMesh(mesh);
  LogInfo("stage=mesh_surface triangles=" + std::to_string(mesh.triangles.size()) +
          " before_simplifying=" + std::to_string(num_full_triangles));
  return mesh;
}

}  // namespace parkade
