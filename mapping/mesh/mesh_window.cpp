#include "mapping/mesh/mesh_window.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "core/error.h"
#include "core/files/for_each_releasing.h"
#include "core/math/fast_floor.h"
#include "core/parallel.h"
#include "mapping/ground/cell_finder.h"
#include "mapping/ground/surface_window.h"
#include "mapping/surface/join_cells.h"

namespace parkade {
namespace {

constexpr int kCellsPerSquare =
    2;  // cells of the surface on each side of a square; more is coarser and smaller
using Colors = std::vector<std::array<std::uint8_t, 3>>;

// Cells that are joined depend on those two further on, vertices that are doubled on two more,
// their colors, too.
constexpr int kMargin = 8;  // [joined cells]
constexpr int kReach = 3;   // [joined cells] that the mesh may go beyond the surface, and some

const double kTileSize = SimplifyMeshOptions{}.tile_size;

const SurfaceCell& FindCell(const CellFinder& finder, const Eigen::Vector3d& vertex) {
  const SurfaceCell* cell = finder.Find(vertex);
  Require(cell != nullptr, ErrorCode::kInternal, "a vertex of the mesh lies off its surface");
  return *cell;
}

SurfaceMap Join(const SurfaceMap& surface, const MeshOptions& options) {
  return JoinCells(surface, kCellsPerSquare, options.free_threshold, options.max_step);
}

HeightMesh Triangulate(const SurfaceMap& joined, const MeshOptions& options) {
  return TriangulateHeights(joined, options.max_step, options.free_threshold);
}

MeshPiece WithColors(SimplifiedPiece&& simplified, const CellFinder& finder) {
  MeshPiece piece;
  piece.simplified = std::move(simplified);
  for (const Eigen::Vector3d& vertex : piece.simplified.mesh.vertices) {
    const SurfaceCell& cell = FindCell(finder, vertex);
    piece.colors.push_back(cell.color);
    piece.height_sigmas.push_back(cell.height_sigma);
    piece.surfaces.push_back(cell.Surface());
  }
  return piece;
}

bool Contains(const Eigen::AlignedBox2i& tiles, const Eigen::Vector3d& center) {
  const Eigen::Array2i at = (center.head<2>() / kTileSize).array().floor().cast<int>();
  return (at >= tiles.min().array()).all() && (at < tiles.max().array()).all();
}

}  // namespace

std::vector<MeshWindow> CutIntoWindows(const SurfaceMap& surface, const MeshOptions& options) {
  const int side =
      std::max(1, static_cast<int>(std::lround(options.window_size / kTileSize)));  // [tiles]
  const int factor = kCellsPerSquare, reach = kReach * factor;
  const double joined_size = surface.cell_size * factor;
  const auto window_of = [&](int cell) {
    return FloorDivide(static_cast<int>(std::floor(cell * surface.cell_size / kTileSize)), side);
  };
  std::map<std::pair<int, int>, std::size_t> found;  // y, x -> cells
  std::vector<std::size_t*> counts;                  // of the windows around the last cell
  Eigen::AlignedBox2i last;
  ForEachReleasing(surface.cells, [&](size_t i) {
    const SurfaceCell& cell = surface.cells[i];
    const Eigen::AlignedBox2i around(
        Eigen::Vector2i(window_of(cell.x - reach), window_of(cell.y - reach)),
        Eigen::Vector2i(window_of(cell.x + reach), window_of(cell.y + reach)));
    if (around.min() != last.min() || around.max() != last.max()) {
      last = around;
      counts.clear();
      for (int y = around.min().y(); y <= around.max().y(); ++y)
        for (int x = around.min().x(); x <= around.max().x(); ++x) counts.push_back(&found[{y, x}]);
    }
    for (std::size_t* count : counts) ++*count;
  });
  std::vector<MeshWindow> windows;
  for (const auto& [at, num_cells] : found) {
    const auto& [y, x] = at;
    const Eigen::Array2i low = side * Eigen::Array2i(x, y), high = low + side;
    const Eigen::Array2i first =
        (low.cast<double>() * kTileSize / joined_size).floor().cast<int>() - kMargin;
    const Eigen::Array2i end =
        (high.cast<double>() * kTileSize / joined_size).ceil().cast<int>() + kMargin;
    windows.push_back({{low.matrix(), high.matrix()},
                       {(first * factor).matrix(), (end * factor).matrix()},
                       num_cells});
  }
  return windows;
}

WindowMesh MeshWindowOf(const SurfaceMap& surface, const MeshWindow& window,
                        const MeshOptions& options) {
  const SurfaceMap joined = Join(CutOut(surface, window.cells), options);
  WindowMesh mesh{.height_mesh = Triangulate(joined, options), .pieces = {}};
  if (mesh.height_mesh.triangles.empty()) return mesh;
  const CellFinder finder(joined);
  const std::vector<Eigen::Vector3d>& vertices = mesh.height_mesh.vertices;
  const Colors colors =
      ParallelMap(vertices.size(), [&](size_t i) { return FindCell(finder, vertices[i]).color; });
  for (const auto& [a, b, c] : mesh.height_mesh.triangles)
    mesh.num_full_triangles +=
        Contains(window.tiles, (vertices[a] + vertices[b] + vertices[c]) / 3);
  for (SimplifiedPiece& piece : SimplifyPieces(
           mesh.height_mesh, colors,
           {.max_error = options.max_height_error, .color_contrast = options.color_contrast},
           window.tiles))
    mesh.pieces.push_back(WithColors(std::move(piece), finder));
  return mesh;
}

WindowMesh MeshWithoutSimplifying(const SurfaceMap& surface, const MeshOptions& options) {
  const SurfaceMap joined = Join(surface, options);
  SimplifiedPiece whole{.mesh = Triangulate(joined, options), .seams = {}};
  whole.seams.assign(whole.mesh.vertices.size(), SimplifiedPiece::kNoSeam);
  WindowMesh mesh;
  mesh.num_full_triangles = whole.mesh.triangles.size();
  mesh.pieces.push_back(WithColors(std::move(whole), CellFinder(joined)));
  return mesh;
}

std::size_t SeamNumbers::HashOfPlace::operator()(const Place& place) const {
  std::size_t hash = 0;
  for (const double coordinate : place)
    hash = 0x9E3779B97F4A7C15U * (hash ^ std::hash<double>{}(coordinate));
  return hash;
}

void SeamNumbers::Renumber(const HeightMesh& mesh, std::vector<MeshPiece>& pieces) {
  std::unordered_map<Place, std::vector<std::uint32_t>, HashOfPlace> vertices_at;  // of the mesh
  for (const MeshPiece& piece : pieces)
    for (const std::uint32_t vertex : piece.simplified.seams)
      if (vertex != SimplifiedPiece::kNoSeam)
        vertices_at.try_emplace(PlaceOf(mesh.vertices[vertex]));
  for (std::uint32_t vertex = 0; vertex < mesh.vertices.size(); ++vertex)
    if (const auto found = vertices_at.find(PlaceOf(mesh.vertices[vertex]));
        found != vertices_at.end())
      found->second.push_back(vertex);
  for (MeshPiece& piece : pieces)
    for (std::uint32_t& vertex : piece.simplified.seams) {
      if (vertex == SimplifiedPiece::kNoSeam) continue;
      const Place place = PlaceOf(mesh.vertices[vertex]);
      const std::vector<std::uint32_t>& here = vertices_at.at(place);
      const auto rank =
          static_cast<std::size_t>(std::find(here.begin(), here.end(), vertex) - here.begin());
      std::vector<std::uint32_t>& numbers = numbers_[place];
      while (numbers.size() <= rank) numbers.push_back(next_++);
      vertex = numbers[rank];
    }
}

}  // namespace parkade
